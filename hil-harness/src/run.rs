//! The loop in lock-step: plant to sensor, sensor to device, device to plant, once per sample.

use core::ops::ControlFlow;

use recording::Recording;

use crate::checks::{JudgeError, Verdict, judge};
use crate::course::{Course, NotRecorded};
use crate::device::{DeviceUnderTest, DutError};
use crate::difference::Difference;
use crate::ecu_under_test::InProcess;
use crate::requirement::Requirement;
use crate::scenario::{Scenario, ScenarioError};
use crate::wire::Exchange;
use crate::world::World;

/// What came of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// All signals on the sample grid from time 0 on. Duty cycles hold from their instant on, currents are means of the
    /// interval before, as in a bench log.
    pub recording: Recording,
    /// Everything that crossed the wire, lead-in included, with what the device told about its inside. Two devices are the
    /// same if these are equal.
    pub exchanges: Vec<Exchange>,
    /// Which device answered.
    pub device: String,
    /// What the device logged, oldest line first.
    pub log: Vec<String>,
}

impl Run {
    /// The first sample in which `device` gave another answer than this one in the same run.
    pub fn first_difference(&self, device: &Self) -> Option<Difference> {
        let mut pairs = self.exchanges.iter().zip(&device.exchanges);
        let (expected, found) = pairs.find(|(expected, found)| expected != found)?;
        Some(Difference {
            sensors: expected.sensors,
            devices: [self.device.clone(), device.device.clone()],
            answers: [expected.answer, found.answer],
        })
    }

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
    /// The device under test failed.
    #[error("{device}: {error}")]
    Device {
        /// Which device.
        device: String,
        /// What happened.
        error: Box<DutError>,
    },
    /// Whoever watched wanted no more.
    #[error("stopped at sample {sample}")]
    Stopped {
        /// The last sample that was run.
        sample: u32,
    },
    /// What was simulated makes no recording.
    #[error(transparent)]
    NotRecorded(#[from] NotRecorded),
}

/// What is seen of a run as it goes.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time of the sample \[s\]; negative in the lead-in.
    pub time_s: f64,
    /// Chamber pressure [bar gauge].
    pub pressure_bar: f64,
    /// What crossed the wire.
    pub exchange: &'a Exchange,
    /// What the device logged since the last moment.
    pub log: &'a [String],
}

/// Between two looks at the device's log \[samples\].
const LOG_EVERY: u32 = 100;

/// Runs `scenario` with the ECU in this process.
///
/// # Errors
/// The scenario or its controller cannot be run.
pub fn run_in_process(scenario: &Scenario) -> Result<Run, RunError> {
    run(scenario, &mut InProcess::new())
}

/// Runs `scenario` with `device` from power-on, with the scenario's settings.
///
/// # Errors
/// The scenario cannot be run, or the device fails.
pub fn run(scenario: &Scenario, device: &mut dyn DeviceUnderTest) -> Result<Run, RunError> {
    run_watched(scenario, device, &mut |_| ControlFlow::Continue(()))
}

/// The same, with each sample shown to `watch`, who may stop it.
///
/// # Errors
/// As [`run`], or it was stopped.
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
    let mut course = Course::for_samples(scenario.duration_samples);
    let lead_in = scenario.lead_in().samples();
    let samples = lead_in + scenario.duration_samples;
    let mut exchanges = Vec::with_capacity(samples as usize);
    let mut log = Vec::new();
    for sample in 0..samples {
        let sensors = world.sense();
        let answer = device.exchange(&sensors).map_err(failed)?;
        let exchange = Exchange { sensors, answer };
        if sample >= lead_in {
            course.add(&world, &exchange);
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
    Ok(Run {
        recording: course.into_recording(scenario, &identity)?,
        exchanges,
        device: identity,
        log,
    })
}
