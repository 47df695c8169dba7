//! Closed loop on the model.

use std::sync::atomic::AtomicBool;

use hil_harness::rigs::{self, RigError, RigVerdict};
use hil_harness::{Run, Verdict, run_in_process};
use schemars::JsonSchema;
use serde::Serialize;

use super::device_report::DeviceReport;
use crate::failure::Failure;
use crate::input::NamedScenario;
use crate::interrupt;
use crate::progress::Progress;

/// Run of the loop and its verdict.
pub(crate) struct Controlled {
    pub(crate) scenario: NamedScenario,
    pub(crate) run: Run,
    pub(crate) verdict: Verdict,
    /// The device; `None` for the ECU in process.
    pub(crate) device: Option<DeviceReport>,
    /// Verdicts on other rigs; empty if none were requested.
    pub(crate) rigs: Vec<RigVerdict>,
}

/// Runs the scenario, then again on `rigs` scattered rigs. `is_interrupted` ends it after the current run.
pub(crate) fn run(
    scenario: NamedScenario,
    rigs: u32,
    is_interrupted: &AtomicBool,
) -> Result<Controlled, Failure> {
    let requirement = scenario.requirements.requirement;
    let run = run_in_process(&scenario.scenario)?;
    interrupt::check(is_interrupted)?;
    let verdict = run.verdict(&requirement)?;
    let progress = Progress::of_count("rigs", rigs.into());
    let scatter = scenario.scatter();
    let rigs = rigs::verdicts_in_operation(&scenario.scenario, &requirement, rigs, scatter);
    let rigs = until_interrupted(rigs.inspect(|_| progress.step()), is_interrupted)?;
    Ok(Controlled {
        scenario,
        run,
        verdict,
        device: None,
        rigs,
    })
}

/// Collects all verdicts, unless `is_interrupted` ends it before the next rig.
fn until_interrupted(
    rigs: impl Iterator<Item = Result<RigVerdict, RigError>>,
    is_interrupted: &AtomicBool,
) -> Result<Vec<RigVerdict>, Failure> {
    rigs.map(|rig| {
        interrupt::check(is_interrupted)?;
        Ok(rig?)
    })
    .collect()
}

impl Controlled {
    /// Returns whether every binding check passes on every rig, and a device answers like the ECU in process.
    pub(crate) fn holds(&self) -> bool {
        self.verdict.holds
            && self.rigs.iter().all(|rig| rig.verdict.holds)
            && self
                .device
                .as_ref()
                .is_none_or(|device| device.difference.is_none())
    }
}

/// Name and version of the JSON form of [`Rigs`].
pub(crate) const RIGS_SCHEMA: &str = "retarder.rigs/4";

/// Closed loop on many rigs.
#[derive(Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Rigs<'a> {
    /// Name and version of this format, `retarder.rigs/4`.
    pub(crate) schema: &'static str,
    /// Name of the scenario.
    pub(crate) scenario: &'a str,
    /// Plant that the rigs are scattered about.
    pub(crate) plant: &'a str,
    /// The controller.
    pub(crate) controller: &'a str,
    /// File of the requirements; `the thesis` for the default.
    pub(crate) requirements: &'a str,
    /// Seed of sensor noise and rigs.
    pub(crate) seed: u64,
    /// Whether every binding check passes on the plant and on every rig.
    pub(crate) holds: bool,
    /// Number of rigs on which every binding check passes.
    pub(crate) rigs_that_hold: usize,
    /// The verdict on the plant itself.
    pub(crate) verdict: &'a Verdict,
    /// The verdicts on the rigs.
    pub(crate) rigs: Vec<Rig<'a>>,
}

/// One rig.
#[derive(Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Rig<'a> {
    /// Number of the rig, from 0.
    pub(crate) rig: u32,
    /// Seed of the rig.
    pub(crate) seed: u64,
    /// Supply voltage (V); at time 0, if it changes; none without coils.
    pub(crate) supply_voltage_v: Option<f64>,
    /// Temperature of the coils (°C); at the start, if it changes; none without coils.
    pub(crate) coil_temperature_c: Option<f64>,
    /// Verdict on the loop with this rig.
    pub(crate) verdict: &'a Verdict,
}

impl Controlled {
    /// Returns the number of rigs on which every binding check passes.
    pub(crate) fn rigs_that_hold(&self) -> usize {
        self.rigs.iter().filter(|rig| rig.verdict.holds).count()
    }

    /// Returns the JSON form of the run and its rigs.
    pub(crate) fn rigs(&self) -> Rigs<'_> {
        Rigs {
            schema: RIGS_SCHEMA,
            scenario: &self.scenario.scenario.name,
            plant: &self.scenario.plant,
            controller: &self.scenario.controller,
            requirements: &self.scenario.requirements.name,
            seed: self.scenario.scenario.seed,
            holds: self.holds(),
            rigs_that_hold: self.rigs_that_hold(),
            verdict: &self.verdict,
            rigs: self
                .rigs
                .iter()
                .map(|rig| Rig {
                    rig: rig.rig,
                    seed: rig.seed,
                    supply_voltage_v: rig.supply_voltage_v,
                    coil_temperature_c: rig.coil_temperature_c,
                    verdict: &rig.verdict,
                })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::Ordering;

    use super::*;
    use hil_harness::Requirement;

    #[test]
    fn a_batch_of_rigs_ends_where_it_is_interrupted() {
        let NamedScenario { scenario, .. } = NamedScenario::built_in("fill-requirement").unwrap();
        let is_interrupted = AtomicBool::new(false);
        let mut begun = 0;
        let rigs = rigs::verdicts(&scenario, &Requirement::THESIS, 4).inspect(|_| {
            begun += 1;
            is_interrupted.store(begun == 2, Ordering::Relaxed);
        });
        let ended = until_interrupted(rigs, &is_interrupted);
        assert!(matches!(ended, Err(Failure::Interrupted)));
        assert_eq!(begun, 2);
    }
}
