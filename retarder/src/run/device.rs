//! Loop on a device, shown live, then compared with the ECU in process.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use hil_harness::run::Moment;
use hil_harness::{Verdict, run_in_process, run_watched};
use schemars::JsonSchema;
use serde::Serialize;

use super::control::Controlled;
use super::device_report::DeviceReport;
use crate::dut::Dut;
use crate::failure::Failure;
use crate::input::NamedScenario;
use crate::interrupt;

/// Scenario and the device to run it on.
pub(crate) struct Task {
    pub(crate) scenario: NamedScenario,
    pub(crate) dut: Dut,
    pub(crate) image: Option<PathBuf>,
    /// Speed of the live plot relative to real time; 0: no limit.
    pub(crate) pace: u32,
}

/// Runs the loop on the device and shows each sample to `watch`; runs it again in process for comparison.
pub(crate) fn run(task: Task, watch: &mut dyn FnMut(&Moment<'_>)) -> Result<Controlled, Failure> {
    let is_interrupted = interrupt::flag()?;
    let scenario = &task.scenario.scenario;
    let watched = task
        .dut
        .under_test(task.image.as_deref())
        .and_then(|mut device| {
            Ok(run_watched(scenario, device.as_mut(), &mut |moment| {
                watch(&moment);
                if is_interrupted.load(Ordering::Relaxed) {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            })?)
        });
    // Ctrl-C also reaches the emulator: an error after it is the requested interruption.
    interrupt::check(is_interrupted)?;
    let run = watched?;
    let verdict = run.verdict(&task.scenario.requirements.requirement)?;
    let difference = run_in_process(scenario)?.first_difference(&run);
    Ok(Controlled {
        device: Some(DeviceReport {
            identity: run.device.clone(),
            log: run.log.clone(),
            samples: run.exchanges.len(),
            difference,
        }),
        scenario: task.scenario,
        run,
        verdict,
        rigs: Vec::new(),
    })
}

/// Name and version of the JSON form of [`Device`].
pub(crate) const DEVICE_SCHEMA: &str = "retarder.device/1";

/// Closed loop on a device.
#[derive(Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Device<'a> {
    /// Name and version of this format, `retarder.device/1`.
    pub(crate) schema: &'static str,
    /// Identity of the device: kind, version and connection.
    pub(crate) device: &'a str,
    /// Name of the scenario.
    pub(crate) scenario: &'a str,
    /// The plant.
    pub(crate) plant: &'a str,
    /// The controller.
    pub(crate) controller: &'a str,
    /// Seed of the sensor noise.
    pub(crate) seed: u64,
    /// Whether every binding check passes and all bits of the device equal those of the ECU in process.
    pub(crate) holds: bool,
    /// Number of samples that crossed the wire, including those before time 0.
    pub(crate) samples: usize,
    /// First sample in which the ECU in process answers differently; null if all bits are equal.
    pub(crate) first_different_sample: Option<u32>,
    /// Log of the device, oldest line first.
    pub(crate) log: &'a [String],
    /// Verdict on the loop.
    pub(crate) verdict: &'a Verdict,
}

impl Controlled {
    /// Returns the JSON form of the run on a device.
    pub(crate) fn on_device<'a>(&'a self, report: &'a DeviceReport) -> Device<'a> {
        Device {
            schema: DEVICE_SCHEMA,
            device: &report.identity,
            scenario: &self.scenario.scenario.name,
            plant: &self.scenario.plant,
            controller: &self.scenario.controller,
            seed: self.scenario.scenario.seed,
            holds: self.holds(),
            samples: report.samples,
            first_different_sample: report
                .difference
                .as_ref()
                .map(|difference| difference.sensors.sample),
            log: &report.log,
            verdict: &self.verdict,
        }
    }
}
