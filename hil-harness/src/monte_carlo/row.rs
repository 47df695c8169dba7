//! Figures of one rig: a row of the table.

use core::slice;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::checks::{Check, CheckId};
use crate::requirement::Requirement;
use crate::rigs::RigVerdict;
use crate::settling_times::SettlingTimes;

/// Figures of one rig. A figure without a case in the run, or of a step that never settled, is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigRow {
    /// Number of the rig, from 0.
    pub rig: u32,
    /// Seed of the rig.
    pub seed: u64,
    /// Supply voltage (V); at time 0, if it changes; none without coils.
    pub supply_voltage_v: Option<f64>,
    /// Temperature of the coils (°C); at the start, if it changes; none without coils.
    pub coil_temperature_c: Option<f64>,
    /// Whether every binding check passes.
    pub holds: bool,
    /// Names of the binding checks that fail, separated by commas.
    pub failed_checks: String,
    /// Names of the faults that the ECU confirmed, in the order of their confirmation, separated by commas.
    pub confirmed_faults: String,
    /// Number of steps to references of the operating range.
    pub steps: u32,
    /// Number of these steps that settle after T_req or never.
    pub late_steps: u32,
    /// Number of these steps that never settle while their reference is constant.
    pub never_settled_steps: u32,
    /// Mean settling time of these steps that settle (samples).
    pub settling_mean_samples: Option<f64>,
    /// Time within which 90 % of these steps settle (samples); none if more than 10 % never do.
    pub settling_p90_samples: Option<f64>,
    /// Settling time of the slowest of these steps (samples); none if one never settles.
    pub settling_worst_samples: Option<f64>,
    /// Largest steady-state error from T_req on (bar).
    pub steady_error_bar: Option<f64>,
    /// Largest pressure beyond a new reference (bar).
    pub overshoot_bar: Option<f64>,
    /// Longest time of the filling, in the reading that binds (samples).
    pub fill_time_samples: Option<f64>,
    /// Longest time of the venting, in the reading that binds (samples).
    pub vent_time_samples: Option<f64>,
    /// Number of samples in which both valves are energised.
    pub both_valves_samples: Option<f64>,
    /// Number of samples in which a duty cycle is outside of its limits.
    pub duty_limits_samples: Option<f64>,
    /// Largest number of valve actuations within a second at rest.
    pub rest_actuations: Option<f64>,
    /// Mean number of lifts of both valves (1/s).
    pub lifts_per_s: Option<f64>,
}

impl RigRow {
    /// Takes the figures from a verdict on `requirement`.
    pub fn new(rig: &RigVerdict, requirement: &Requirement) -> Self {
        let verdict = &rig.verdict;
        let failed = |check: &&Check| check.binding && !check.holds;
        let failed = verdict.checks.iter().filter(failed);
        let faults = verdict.confirmed_faults.as_deref().unwrap_or_default();
        let reached = |id| verdict.check(id).and_then(|check| check.reached);
        let binding = |readings: [CheckId; 4]| {
            let mut checks = readings.into_iter().filter_map(|id| verdict.check(id));
            let check = checks.find(|check| check.binding);
            check.and_then(|check| check.reached)
        };
        let settling = SettlingTimes::of_steps(slice::from_ref(rig));
        let in_time = settling
            .samples
            .partition_point(|&time| time <= requirement.t_req_samples);
        Self {
            rig: rig.rig,
            seed: rig.seed,
            supply_voltage_v: rig.supply_voltage_v,
            coil_temperature_c: rig.coil_temperature_c,
            holds: verdict.holds,
            failed_checks: names(failed.map(|check| check.id.name())),
            confirmed_faults: names(faults.iter().map(|fault| fault.fault.as_str())),
            steps: settling.count() as u32,
            late_steps: (settling.count() - in_time) as u32,
            never_settled_steps: settling.never as u32,
            settling_mean_samples: mean(&settling.samples),
            settling_p90_samples: settling.quantile(0.9).map(f64::from),
            settling_worst_samples: settling.quantile(1.0).map(f64::from),
            steady_error_bar: reached(CheckId::SteadyError),
            overshoot_bar: reached(CheckId::Overshoot),
            fill_time_samples: binding([
                CheckId::FillTime,
                CheckId::FillTimeWithDeadTime,
                CheckId::FillTimeToLevel,
                CheckId::FillTimeToLevelWithDeadTime,
            ]),
            vent_time_samples: binding([
                CheckId::VentTime,
                CheckId::VentTimeWithDeadTime,
                CheckId::VentTimeToLevel,
                CheckId::VentTimeToLevelWithDeadTime,
            ]),
            both_valves_samples: reached(CheckId::NeverBothValves),
            duty_limits_samples: reached(CheckId::DutyLimits),
            rest_actuations: reached(CheckId::RestActuations),
            lifts_per_s: verdict.actuations.map(|actuations| actuations.per_s),
        }
    }
}

/// Separator of names in a text.
const SEPARATOR: &str = ",";

fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(SEPARATOR)
}

/// Returns the names in a text of a row.
pub(super) fn names_in(text: &str) -> impl Iterator<Item = &str> {
    text.split(SEPARATOR).filter(|name| !name.is_empty())
}

fn mean(samples: &[u32]) -> Option<f64> {
    let sum: f64 = samples.iter().copied().map(f64::from).sum();
    (!samples.is_empty()).then(|| sum / samples.len() as f64)
}
