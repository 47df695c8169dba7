//! Loop in lock step: plant to sensor, sensor to device, device to plant, once per sample.

use core::ops::ControlFlow;

use controller::Settings;
use ecu::VentValve;
use plant_sim::valve::ValveFunction;
use recording::Recording;

use crate::checks::{JudgeError, Verdict, judge};
use crate::confirmed_fault::{self, ConfirmedFault};
use crate::device::{DeviceUnderTest, DutError};
use crate::difference::Difference;
use crate::duty_factors::duty_factors;
use crate::ecu_under_test::InProcess;
use crate::requirement::Requirement;
use crate::scenario::{Scenario, ScenarioError};
use crate::trace::{NotRecorded, Trace};
use crate::wire::Exchange;
use crate::world::World;

/// Result of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// All signals on the sample grid from time 0 on. Duty cycles are valid from their instant on, currents are means
    /// of the interval before, as in a bench log.
    pub recording: Recording,
    /// All data on the wire, including the lead-in, with the telemetry of the device. If these are equal for two
    /// devices, the devices behave equally.
    pub exchanges: Vec<Exchange>,
    /// Identity of the device.
    pub device: String,
    /// Log of the device, oldest line first.
    pub log: Vec<String>,
    /// Settings of the controller, which decide whether both valves may be energised together, and with which duty cycles.
    pub controller: Settings,
    /// Smallest and largest factor by which the conditions of the run multiply the duty limits.
    pub duty_factors: [f64; 2],
    /// Position of the vent valve without current, as the ECU was told.
    pub vent_valve: VentValve,
    /// Whether the fill and the vent valve have a coil.
    pub has_coil: [bool; 2],
}

impl Run {
    /// Returns the first sample in which `device` gave another answer than this one in the same run.
    pub fn first_difference(&self, device: &Self) -> Option<Difference> {
        let mut pairs = self.exchanges.iter().zip(&device.exchanges);
        let (expected, found) = pairs.find(|(expected, found)| expected != found)?;
        Some(Difference {
            sensors: expected.sensors,
            devices: [self.device.clone(), device.device.clone()],
            answers: [expected.answer, found.answer],
        })
    }

    /// Judges the run by `requirement`, and names the faults that the ECU confirmed.
    ///
    /// # Errors
    /// Returns an error if a signal is missing, which never occurs in a run of [`run`].
    pub fn verdict(&self, requirement: &Requirement) -> Result<Verdict, JudgeError> {
        let requirement = requirement
            .with_controller(&self.controller)
            .with_duty_factors(self.duty_factors)
            .with_valves(self.vent_valve, self.has_coil);
        let verdict = judge(&self.recording, &requirement)?;
        Ok(Verdict {
            confirmed_faults: Some(self.confirmed_faults()),
            ..verdict
        })
    }

    /// Returns the faults that the ECU confirmed, in the order of their first confirmation.
    pub fn confirmed_faults(&self) -> Vec<ConfirmedFault> {
        let Some(times) = self.recording.time_base_of("p_ref") else {
            return Vec::new();
        };
        let lead_in = self.exchanges.len() - times.len();
        let sample_s = times.sampling().median_step_s.unwrap_or_default();
        confirmed_fault::confirmed(&self.exchanges, lead_in, sample_s)
    }
}

/// Reason why a run has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scenario cannot be run.
    #[error("scenario: {0}")]
    Scenario(#[from] ScenarioError),
    /// The device under test failed.
    #[error("{device}: {error}")]
    Device {
        /// Identity of the device.
        device: String,
        /// Error of the device.
        error: Box<DutError>,
    },
    /// The observer stopped the run.
    #[error("stopped at sample {sample}")]
    Stopped {
        /// Number of the last sample.
        sample: u32,
    },
    /// The simulated data gives no recording.
    #[error(transparent)]
    NotRecorded(#[from] NotRecorded),
}

/// Data of one sample, for an observer of the run.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time of the sample (s); negative in the lead-in.
    pub time_s: f64,
    /// Chamber pressure (bar gauge).
    pub pressure_bar: f64,
    /// Data on the wire.
    pub exchange: &'a Exchange,
    /// Log of the device since the last sample shown.
    pub log: &'a [String],
}

/// Number of samples between two reads of the device's log.
const LOG_EVERY: u32 = 100;

/// Runs `scenario` with the ECU in this process.
///
/// # Errors
/// Returns an error if the scenario or its controller cannot be run.
pub fn run_in_process(scenario: &Scenario) -> Result<Run, RunError> {
    run(scenario, &mut InProcess::new())
}

/// Runs `scenario` with `device` from power-on, with the scenario's settings.
///
/// # Errors
/// Returns an error if the scenario cannot be run, or the device fails.
pub fn run(scenario: &Scenario, device: &mut dyn DeviceUnderTest) -> Result<Run, RunError> {
    run_watched(scenario, device, &mut |_| ControlFlow::Continue(()))
}

/// Runs `scenario` and passes each sample to `watch`, which may stop the run.
///
/// # Errors
/// Returns the errors of [`run`], or an error if the run was stopped.
pub fn run_watched(
    scenario: &Scenario,
    device: &mut dyn DeviceUnderTest,
    watch: &mut dyn FnMut(Moment<'_>) -> ControlFlow<()>,
) -> Result<Run, RunError> {
    scenario.check()?;
    let identity = device.identity();
    let failed = |error: DutError| RunError::Device {
        device: identity.clone(),
        error: Box::new(error),
    };
    device.start(&scenario.ecu_settings()).map_err(failed)?;
    let mut world = World::new(scenario);
    let mut trace = Trace::for_samples(scenario.duration_samples);
    let lead_in = scenario.lead_in().samples();
    let samples = lead_in + scenario.duration_samples;
    let mut exchanges = Vec::with_capacity(samples as usize);
    let mut log = Vec::new();
    for sample in 0..samples {
        let sensors = world.sense();
        let answer = device.exchange(&sensors).map_err(failed)?;
        let exchange = Exchange { sensors, answer };
        if sample >= lead_in {
            trace.add(&world, &exchange);
        }
        exchanges.push(exchange);
        let logged = log.len();
        if sample % LOG_EVERY == 0 || sample + 1 == samples {
            log.extend(device.take_log().map_err(failed)?);
        }
        let moment = Moment {
            time_s: (f64::from(sample) - f64::from(lead_in)) * scenario.plant.ecu.sample_time_s,
            pressure_bar: world.pressure_bar(),
            exchange: &exchange,
            log: log.get(logged..).unwrap_or_default(),
        };
        if watch(moment).is_break() {
            return Err(RunError::Stopped { sample });
        }
        world.actuate(answer.actuators);
    }
    let duty_factors = duty_factors(scenario, &exchanges);
    Ok(Run {
        recording: trace.into_recording(scenario, &identity)?,
        exchanges,
        device: identity,
        log,
        controller: scenario.controller,
        duty_factors,
        vent_valve: scenario.ecu_settings().vent_valve,
        has_coil: scenario.plant.functions.map(ValveFunction::has_coil),
    })
}
