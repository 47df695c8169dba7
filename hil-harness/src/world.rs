//! Environment of the ECU: the plant, its pressure sensor, its coil currents, its battery, and the reference.

use plant_sim::{Command, Sample, Simulator};

use crate::random::{Random, Stream};
use crate::scenario::Scenario;
use crate::sensor;
use crate::wire::{self, Actuators, Sensors};

/// Interval at which the armatures are observed (ns): a full stroke and back takes several milliseconds.
const WATCH_NS: u64 = 1_000_000;
/// Share of the stroke above which an armature counts as lifted.
const LIFTED_ABOVE: f64 = 0.10;
/// Share of the stroke below which a lifted armature counts as down again.
const DOWN_BELOW: f64 = 0.05;

/// World of a scenario, sample by sample: sense, then actuate.
#[derive(Clone, Debug)]
pub struct World<'a> {
    scenario: &'a Scenario,
    simulator: Simulator,
    noise: Random,
    sample_ns: u64,
    /// Number of samples sensed so far.
    samples: u32,
    shown: Sample,
    lifts: [Lifts; 2],
}

impl<'a> World<'a> {
    /// Creates the scenario's world at power-on: the chamber at ambient pressure, valves at rest.
    pub fn new(scenario: &'a Scenario) -> Self {
        let mut simulator = Simulator::new(&scenario.plant);
        Self {
            scenario,
            shown: simulator.sample(),
            simulator,
            noise: Random::new(scenario.seed, Stream::SensorNoise),
            sample_ns: scenario.plant.ecu.sample_time_ns(),
            samples: 0,
            lifts: [Lifts::default(); 2],
        }
    }

    /// Returns the inputs of the ECU in the next sample, without a fault.
    pub fn sense(&mut self) -> Sensors {
        let sample = self.samples;
        self.samples += 1;
        let lead_in = self.scenario.lead_in();
        if sample == lead_in.samples() && self.scenario.start_pressure_bar > 0.0 {
            self.simulator
                .set_chamber_pressure(self.scenario.start_pressure_pa());
        }
        self.shown = self.simulator.sample();
        let reference_bar = match sample.checked_sub(lead_in.samples()) {
            Some(run) => self
                .scenario
                .reference
                .at_ns(u64::from(run) * self.sample_ns),
            None => lead_in.reference_bar(sample),
        };
        // Counted from time 0, so that a longer lead-in changes no draw after it.
        let draw = u64::from(sample).wrapping_sub(lead_in.samples().into());
        let noise_pa = 100.0 * self.scenario.sensor_noise_mbar_rms * self.noise.normal(draw);
        let [current_fill, current_vent] = self.shown.mean_current;
        Sensors {
            sample,
            elapsed_us: u32::try_from(self.sample_ns / 1000).unwrap_or(u32::MAX),
            reference: Some(wire::reference_bits(reference_bar)),
            pressure: Some(sensor::code(self.shown.pressure + noise_pa).bits()),
            current_fill_ma: Some(wire::current_ma(current_fill)),
            current_vent_ma: Some(wire::current_ma(current_vent)),
            battery_mv: Some(wire::battery_mv(self.scenario.plant.ecu.supply_voltage_v)),
        }
    }

    /// Applies duty cycles to the coils until the next sample.
    pub fn actuate(&mut self, actuators: Actuators) {
        self.simulator.command(Command {
            duty_fill_pct: wire::duty_pct(actuators.duty_fill),
            duty_vent_pct: wire::duty_pct(actuators.duty_vent),
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

    /// Returns the plant at the ECU's last measurement.
    pub fn shown(&self) -> &Sample {
        &self.shown
    }

    /// Returns the chamber pressure at the ECU's last measurement (bar gauge).
    pub fn pressure_bar(&self) -> f64 {
        (self.shown.pressure - self.scenario.plant.gas.ambient_pressure_pa) / 1e5
    }

    /// Returns the numbers of lifts of the fill and the vent valve since power-on.
    pub fn lifts(&self) -> [u32; 2] {
        self.lifts.map(|lifts| lifts.count)
    }

    /// Returns the plant, to apply a fault.
    pub fn simulator_mut(&mut self) -> &mut Simulator {
        &mut self.simulator
    }
}

/// Counter of an armature's lifts.
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
