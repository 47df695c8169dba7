//! The loop in lock-step: plant to sensor, sensor to device, device to plant, once per sample.

use plant_sim::{Command, Simulator};
use recording::{AddSignalError, Provenance, Recording, TimeBase, TimeBaseError, Unit};

use crate::checks::{JudgeError, Verdict, judge};
use crate::device::{DeviceUnderTest, DutError, InProcess, Telemetry};
use crate::random::{Random, Stream};
use crate::requirement::Requirement;
use crate::scenario::{Scenario, ScenarioError};
use crate::sensor::PressureSensor;
use crate::wire::{Actuators, ReferenceCode, Sensors};

/// What came of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// All signals on the sample grid. Duty cycles hold from their instant on, currents are means of the interval before,
    /// as in a bench log.
    pub recording: Recording,
    /// Everything that crossed the wire, with what the device told about its inside. Two devices are the same if these are equal.
    pub exchanges: Vec<Exchange>,
    /// Which device answered.
    pub device: String,
}

/// One sample on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Exchange {
    /// To the device.
    pub sensors: Sensors,
    /// From the device.
    pub actuators: Actuators,
    /// The device's inside after the sample, where it tells.
    pub telemetry: Option<Telemetry>,
}

impl Run {
    /// How the run stands against `requirement`.
    ///
    /// # Errors
    /// A signal is missing, which a run of [`run`] never lacks.
    pub fn verdict(&self, requirement: &Requirement) -> Result<Verdict, JudgeError> {
        judge(&self.recording, requirement)
    }
}

/// Why a run has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scenario cannot be run.
    #[error("scenario: {0}")]
    Scenario(#[from] ScenarioError),
    /// The controller's settings are out of bounds.
    #[error("controller: {0}")]
    Controller(#[from] controller::ConfigError),
    /// The device under test failed.
    #[error("{device}: {error}")]
    Device {
        /// Which device.
        device: String,
        /// What happened.
        error: DutError,
    },
    /// The instants make no time base.
    #[error(transparent)]
    TimeBase(#[from] TimeBaseError),
    /// The simulated values make no signal.
    #[error(transparent)]
    Signal(#[from] AddSignalError),
}

/// How often the armatures are watched [ns]: a full stroke and back takes several milliseconds.
const WATCH_NS: u64 = 1_000_000;
/// An armature is lifted beyond this share of its stroke ...
const LIFTED_ABOVE: f64 = 0.10;
/// ... and down again below this one.
const DOWN_BELOW: f64 = 0.05;

/// Runs `scenario` with the controller crate in this process.
///
/// # Errors
/// The scenario or its controller cannot be run.
pub fn run_in_process(scenario: &Scenario) -> Result<Run, RunError> {
    run(scenario, &mut InProcess::new(&scenario.controller)?)
}

/// Runs `scenario` with `device` from power-on. The scenario's controller settings are not sent: a device that carries its own
/// is built from the same file.
///
/// # Errors
/// The scenario cannot be run, or the device fails.
pub fn run(scenario: &Scenario, device: &mut dyn DeviceUnderTest) -> Result<Run, RunError> {
    scenario.check()?;
    let identity = device.identity();
    let failed = |error| RunError::Device {
        device: identity.clone(),
        error,
    };
    device.reset().map_err(failed)?;
    let mut world = World::new(scenario);
    let mut log = Log::for_samples(scenario.duration_samples);
    let mut exchanges = Vec::with_capacity(scenario.duration_samples as usize);
    for sample in 0..scenario.duration_samples {
        let sensors = world.sense(sample);
        let actuators = device.exchange(sensors).map_err(failed)?;
        let exchange = Exchange {
            sensors,
            actuators,
            telemetry: device.telemetry(),
        };
        log.add(&world, &exchange);
        exchanges.push(exchange);
        world.actuate(actuators);
    }
    let recording = log.into_recording(scenario, &identity)?;
    Ok(Run {
        recording,
        exchanges,
        device: identity,
    })
}

/// The plant, its sensor and its reference.
struct World<'a> {
    scenario: &'a Scenario,
    simulator: Simulator,
    noise: Random,
    ambient_pressure: f64,
    sample_ns: u64,
    shown: plant_sim::Sample,
    lifts: [Lifts; 2],
}

impl<'a> World<'a> {
    fn new(scenario: &'a Scenario) -> Self {
        let mut simulator = Simulator::new(&scenario.plant);
        let ambient_pressure = scenario.plant.gas.ambient_pressure_pa;
        if scenario.start_pressure_bar > 0.0 {
            simulator.set_chamber_pressure(ambient_pressure + scenario.start_pressure_bar * 1e5);
        }
        Self {
            scenario,
            shown: simulator.sample(),
            simulator,
            noise: Random::new(scenario.seed, Stream::SensorNoise),
            ambient_pressure,
            sample_ns: scenario.plant.ecu.sample_time_ns(),
            lifts: [Lifts::default(); 2],
        }
    }

    fn sense(&mut self, sample: u32) -> Sensors {
        self.shown = self.simulator.sample();
        let noise_pa =
            100.0 * self.scenario.sensor_noise_mbar_rms * self.noise.normal(sample.into());
        Sensors {
            sample,
            reference: ReferenceCode::nearest(self.scenario.reference.at_ns(self.shown.time_ns)),
            pressure: PressureSensor::code(self.shown.pressure + noise_pa),
        }
    }

    fn actuate(&mut self, actuators: Actuators) {
        self.simulator.command(Command {
            duty_fill_pct: actuators.duty_fill.percent(),
            duty_vent_pct: actuators.duty_vent.percent(),
        });
        let stroke = self.scenario.plant.armature.stroke_m;
        let end_ns = self.simulator.time_ns() + self.sample_ns;
        while self.simulator.time_ns() < end_ns {
            let watch_ns = self.simulator.time_ns() + WATCH_NS;
            self.simulator.advance_to_ns(watch_ns.min(end_ns));
            for (lifts, valve) in self.lifts.iter_mut().zip(&self.simulator.state().valves) {
                lifts.watch(valve.x / stroke);
            }
        }
    }

    fn gauge_bar(&self, pressure: f64) -> f64 {
        (pressure - self.ambient_pressure) / 1e5
    }
}

/// Counts how often an armature is lifted.
#[derive(Clone, Copy, Debug, Default)]
struct Lifts {
    is_lifted: bool,
    count: u32,
}

impl Lifts {
    fn watch(&mut self, share_of_stroke: f64) {
        if self.is_lifted {
            self.is_lifted = share_of_stroke >= DOWN_BELOW;
        } else if share_of_stroke > LIFTED_ABOVE {
            self.is_lifted = true;
            self.count += 1;
        }
    }
}

/// The signals of a run, by name and unit.
struct Log {
    columns: [(&'static str, Unit, Vec<f64>); 12],
}

impl Log {
    fn for_samples(samples: u32) -> Self {
        let columns = [
            ("p_ref", Unit::BarGauge),
            ("p_ch", Unit::BarGauge),
            ("p_ch_measured", Unit::BarGauge),
            ("duty_fill", Unit::Percent),
            ("duty_vent", Unit::Percent),
            ("u", Unit::Percent),
            ("i_fill", Unit::Milliampere),
            ("i_vent", Unit::Milliampere),
            ("x_fill", Unit::Millimetre),
            ("x_vent", Unit::Millimetre),
            ("actuations_fill", Unit::Count),
            ("actuations_vent", Unit::Count),
        ];
        Self {
            columns: columns.map(|(name, unit)| (name, unit, Vec::with_capacity(samples as usize))),
        }
    }

    fn add(&mut self, world: &World<'_>, exchange: &Exchange) {
        let Exchange {
            sensors,
            actuators,
            telemetry,
        } = exchange;
        let shown = &world.shown;
        let row = [
            sensors.reference.bar(),
            world.gauge_bar(shown.pressure),
            f64::from(PressureSensor::pressure(sensors.pressure).to_bits()) / 65536.0,
            actuators.duty_fill.percent(),
            actuators.duty_vent.percent(),
            telemetry.map_or(f64::NAN, |telemetry| telemetry.control_signal_pct()),
            1e3 * shown.mean_current[0],
            1e3 * shown.mean_current[1],
            1e3 * shown.position[0],
            1e3 * shown.position[1],
            world.lifts[0].count.into(),
            world.lifts[1].count.into(),
        ];
        for ((_, _, column), value) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
    }

    fn into_recording(self, scenario: &Scenario, device: &str) -> Result<Recording, RunError> {
        let mut provenance = Provenance::from_source(format!("scenario {}", scenario.name))
            .with_note("device", device)
            .with_note("seed", scenario.seed.to_string());
        provenance.producer = Some(concat!("hil-harness ", env!("CARGO_PKG_VERSION")).to_owned());
        let mut recording = Recording::new(provenance);
        let samples = scenario.duration_samples as usize;
        let time_base = TimeBase::uniform(0.0, scenario.plant.ecu.sample_time_s, samples)?;
        let time_base = recording.add_time_base(time_base);
        for (name, unit, column) in self.columns {
            recording.add_signal(name, unit, time_base, column)?;
        }
        Ok(recording)
    }
}
