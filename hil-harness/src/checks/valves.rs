//! Duty cycles and movements of the valves.

use ecu::VentValve;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check::{Bound, Check, CheckId};
use super::steps::{StepResponse, place_of};
use super::trajectory::Trajectory;
use crate::requirement::{BothValves, Requirement};

/// Numbers of valve actuations in the whole recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Actuations {
    /// Fill valve.
    pub fill: u32,
    /// Vent valve.
    pub vent: u32,
    /// Both valves, per second of the recording (1/s).
    pub per_s: f64,
}

/// Resolution of a duty cycle on the wire (%): a smaller deviation is none.
const ROUNDING_PCT: f64 = 1.0 / 65536.0;

/// Checks that both valves are never energised together, unless the requirement allows it. A loop with an unknown
/// distributor is judged like one with Scheme 1.
pub(super) fn never_both(trajectory: &Trajectory, requirement: &Requirement) -> Option<Check> {
    if requirement.both_valves == BothValves::Allowed {
        return None;
    }
    let both = |&index: &usize| {
        let opening_pct = openings_pct(trajectory, requirement, index);
        opening_pct.iter().all(|&opening_pct| opening_pct > 0.0)
    };
    let both_are = match requirement.vent_valve {
        VentValve::NormallyClosed => "energised",
        VentValve::NormallyOpen => "opened",
    };
    Some(count_of(
        CheckId::NeverBothValves,
        format!("the two valves are never {both_are} in the same sample (Scheme 1, section 6.3.1)"),
        trajectory,
        both,
    ))
}

/// Returns the duty cycles of the openings of both valves in a sample (%).
fn openings_pct(trajectory: &Trajectory, requirement: &Requirement, index: usize) -> [f64; 2] {
    let [fill, vent] = trajectory.duty.each_ref().map(|duty| duty[index]);
    match requirement.vent_valve {
        VentValve::NormallyClosed => [fill, vent],
        VentValve::NormallyOpen => [fill, 100.0 - vent],
    }
}

/// Checks that a duty cycle is 0 or within its limits, which pulses, normally open valves and valves without a coil do not have.
pub(super) fn duty_limits(trajectory: &Trajectory, requirement: &Requirement) -> Option<Check> {
    if requirement.is_pulsed {
        return None;
    }
    let [factor_min, factor_max] = requirement.duty_factors;
    let scaled = |[min, max]: [f64; 2]| [factor_min * min, (factor_max * max).min(100.0)];
    let is_normally_closed = requirement.vent_valve == VentValve::NormallyClosed;
    let [fill_has_coil, vent_has_coil] = requirement.has_coil;
    let valves = [
        ("fill", requirement.duty_fill_pct, fill_has_coil),
        (
            "vent",
            requirement.duty_vent_pct,
            vent_has_coil && is_normally_closed,
        ),
    ];
    let limited = valves.iter().zip(&trajectory.duty);
    let limited = limited.filter(|((.., is_limited), _)| *is_limited);
    let limited: Vec<_> = limited
        .map(|(&(name, limits_pct, _), duty)| (name, limits_pct, scaled(limits_pct), duty))
        .collect();
    if limited.is_empty() {
        return None;
    }
    let within: Vec<String> = limited
        .iter()
        .map(|(name, [min, max], ..)| format!("{min} to {max} % ({name} valve)"))
        .collect();
    let within = within.join(" and ");
    let beyond = |&index: &usize| {
        limited.iter().any(|(.., [min, max], duty)| {
            let duty = duty[index];
            duty != 0.0 && !(min - ROUNDING_PCT..=max + ROUNDING_PCT).contains(&duty)
        })
    };
    Some(count_of(
        CheckId::DutyLimits,
        format!(
            "a duty cycle is 0 or within {within}{}{}",
            compensated(requirement),
            requirement.cite("tables 4.1, 4.2, section 6.3.1")
        ),
        trajectory,
        beyond,
    ))
}

/// Returns the factors of the duty limits as a part of a sentence; nothing without compensation.
fn compensated(requirement: &Requirement) -> String {
    match requirement.duty_factors {
        [1.0, 1.0] => String::new(),
        [min, max] => {
            format!(", times {min:.2} to {max:.2} for supply voltage and coil resistance")
        }
    }
}

/// Creates a check that allows no sample.
fn count_of(
    id: CheckId,
    requirement: String,
    trajectory: &Trajectory,
    breaks: impl Fn(&usize) -> bool,
) -> Check {
    let samples = trajectory.len();
    let count = (0..samples).filter(&breaks).count();
    let evidence = match (0..samples).find(&breaks) {
        None => format!("{samples} samples"),
        Some(index) => format!(
            "first at {:.2} s, of {samples} samples",
            trajectory.time_s(index)
        ),
    };
    Check {
        id,
        requirement,
        bound: Bound::AtMost,
        limit: 0.0,
        reached: Some(count as f64),
        unit: "samples".to_owned(),
        holds: count == 0,
        binding: true,
        evidence,
    }
}

/// Checks that at rest, after T_req, the valves hardly move: no limit cycle.
pub(super) fn rest_actuations(
    trajectory: &Trajectory,
    steps: &[StepResponse],
    requirement: &Requirement,
) -> Option<Check> {
    let actuations = trajectory.actuations.as_ref()?;
    let (worst, count) = steps
        .iter()
        .filter(|step| step.in_operating_range)
        .map(|step| {
            (
                step,
                most_within_a_second(trajectory, actuations, step, requirement),
            )
        })
        .max_by_key(|(_, count)| *count)?;
    let limit = requirement.rest_actuations_per_s;
    Some(Check {
        id: CheckId::RestActuations,
        requirement: format!(
            "from T_req on the valves move at most {limit} times within a second{}",
            requirement.cite("not required; ours: no limit cycle")
        ),
        bound: Bound::AtMost,
        limit: limit.into(),
        reached: Some(count.into()),
        unit: "actuations".to_owned(),
        holds: count <= limit,
        binding: requirement.is_rest_binding,
        evidence: place_of(worst),
    })
}

fn most_within_a_second(
    trajectory: &Trajectory,
    actuations: &[Vec<f64>; 2],
    step: &StepResponse,
    requirement: &Requirement,
) -> u32 {
    let first = step.index + requirement.t_req_samples as usize;
    let last = (step.index + step.held_samples as usize).min(trajectory.len() - 1);
    let second = (1.0 / trajectory.sample_s).round() as usize;
    let both = |index: usize| actuations[0][index] + actuations[1][index];
    (first..=last)
        .map(|index| (both(index) - both(index.saturating_sub(second).max(first))) as u32)
        .max()
        .unwrap_or(0)
}

/// Checks the mean number of lifts, if the requirement limits it.
pub(super) fn lifts(trajectory: &Trajectory, requirement: &Requirement) -> Option<Check> {
    let limit = requirement.lifts_per_s?;
    let Actuations { fill, vent, per_s } = actuations(trajectory)?;
    Some(Check {
        id: CheckId::Lifts,
        requirement: format!("the valves lift at most {limit} times per second, on average"),
        bound: Bound::AtMost,
        limit,
        reached: Some(per_s),
        unit: "1/s".to_owned(),
        holds: per_s <= limit,
        binding: true,
        evidence: format!("{fill} of the fill valve, {vent} of the vent valve"),
    })
}

/// Returns the totals of the recording.
pub(super) fn actuations(trajectory: &Trajectory) -> Option<Actuations> {
    let [fill, vent] = trajectory.actuations.as_ref()?.each_ref().map(|counts| {
        let total = counts
            .last()
            .zip(counts.first())
            .map_or(0.0, |(last, first)| last - first);
        total as u32
    });
    let duration_s = trajectory.sample_s * trajectory.len() as f64;
    Some(Actuations {
        fill,
        vent,
        per_s: f64::from(fill + vent) / duration_s,
    })
}
