//! Step responses of the pressure.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check::{Bound, Check, CheckId};
use super::trajectory::Trajectory;
use crate::requirement::Requirement;

/// Response to one step of the reference, which then stays constant for at least T_req.
///
/// Samples count from 0, the sample that first shows the new reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepResponse {
    /// Instant of the step (s).
    pub time_s: f64,
    /// Index of the step's sample in the recording.
    pub index: usize,
    /// Previous reference (bar gauge); the pressure itself if the recording begins with the step.
    pub previous_bar: f64,
    /// Chamber pressure at the step (bar gauge).
    pub from_bar: f64,
    /// New reference (bar gauge).
    pub to_bar: f64,
    /// Whether the retarder uses the new reference (section 6.4.2).
    pub in_operating_range: bool,
    /// Duration for which the reference was constant (samples).
    pub held_samples: u32,
    /// First sample within P_tol of the reference; none if never.
    pub reached_samples: Option<u32>,
    /// First sample from which on the pressure stayed within P_tol of the reference; none if never.
    pub settled_samples: Option<u32>,
    /// Overshoot: largest pressure beyond the reference (bar).
    pub overshoot_bar: f64,
    /// Steady-state error: largest magnitude of the error from T_req on (bar).
    pub steady_error_bar: f64,
}

/// Rounding error of decimal numbers (bar): a smaller deviation is none.
pub(super) const ROUNDING_BAR: f64 = 1e-9;

/// Returns every step whose reference is constant for T_req or longer. The samples of a ramp are shorter steps.
pub(super) fn responses(trajectory: &Trajectory, requirement: &Requirement) -> Vec<StepResponse> {
    let reference = &trajectory.reference;
    let mut steps = Vec::new();
    let mut start = 0;
    while start < reference.len() {
        let is_same = |value: &&f64| **value == reference[start];
        let end = start + reference[start..].iter().take_while(is_same).count();
        // The first reference is a step if the pressure differs from it.
        let is_step = start > 0
            || (trajectory.pressure[0] - reference[0]).abs() > requirement.p_tol_bar + ROUNDING_BAR;
        if is_step && end - start >= requirement.t_req_samples as usize {
            steps.extend(response(trajectory, requirement, start, end));
        }
        start = end;
    }
    steps
}

fn response(
    trajectory: &Trajectory,
    requirement: &Requirement,
    start: usize,
    end: usize,
) -> Option<StepResponse> {
    let to_bar = trajectory.reference[start];
    // The response to the next reference begins after its sample, so that sample still belongs to this step.
    let last = end.min(trajectory.len() - 1);
    let answer = &trajectory.pressure[start..=last];
    let t_req = requirement.t_req_samples as usize;
    let steady = answer.get(t_req..).filter(|rest| !rest.is_empty())?;
    let is_inside =
        |pressure: &f64| (pressure - to_bar).abs() <= requirement.p_tol_bar + ROUNDING_BAR;
    let from_bar = answer[0];
    let direction = (to_bar - from_bar).signum();
    let settled = answer.len() - answer.iter().rev().take_while(|p| is_inside(p)).count();
    Some(StepResponse {
        time_s: trajectory.time_s(start),
        index: start,
        previous_bar: start
            .checked_sub(1)
            .map_or(from_bar, |before| trajectory.reference[before]),
        from_bar,
        to_bar,
        in_operating_range: requirement.is_operating_reference(to_bar),
        held_samples: (end - start) as u32,
        reached_samples: answer.iter().position(is_inside).map(|n| n as u32),
        settled_samples: (settled < answer.len()).then_some(settled as u32),
        overshoot_bar: answer
            .iter()
            .map(|p| direction * (p - to_bar))
            .fold(0.0, f64::max),
        steady_error_bar: steady
            .iter()
            .map(|p| (p - to_bar).abs())
            .fold(0.0, f64::max),
    })
}

/// Checks that all steps to references of the operating range settle within T_req.
pub(super) fn settling_time(steps: &[StepResponse], requirement: &Requirement) -> Option<Check> {
    let id = CheckId::SettlingTime;
    settling(
        id,
        steps.iter().filter(|step| step.in_operating_range),
        requirement,
    )
}

/// Evaluates the same beyond the operating range, for information.
pub(super) fn settling_time_beyond_operating_range(
    steps: &[StepResponse],
    requirement: &Requirement,
) -> Option<Check> {
    let id = CheckId::SettlingTimeBeyondOperatingRange;
    settling(
        id,
        steps.iter().filter(|step| !step.in_operating_range),
        requirement,
    )
}

fn settling<'a>(
    id: CheckId,
    steps: impl Iterator<Item = &'a StepResponse> + Clone,
    requirement: &Requirement,
) -> Option<Check> {
    // A step that never settled counts as the slowest one.
    let worst = steps
        .clone()
        .max_by_key(|step| step.settled_samples.unwrap_or(u32::MAX))?;
    let limit = f64::from(requirement.t_req_samples);
    let reached = worst.settled_samples.map(f64::from);
    let late = steps
        .clone()
        .filter(|step| {
            step.settled_samples
                .is_none_or(|n| n > requirement.t_req_samples)
        })
        .count();
    let binding = id == CheckId::SettlingTime;
    let [low, high] = requirement.operating_range_psup;
    let place = if binding { "in" } else { "outside" };
    Some(Check {
        id,
        requirement: format!(
            "every reference {place} {low} to {high} p_sup is reached within T_req, and the pressure then stays within \
             {} bar{}",
            requirement.p_tol_bar,
            requirement.cite("sections 1.4, 6.4.2")
        ),
        bound: Bound::AtMost,
        limit,
        reached,
        unit: "samples".to_owned(),
        holds: Bound::AtMost.allows(reached, limit),
        binding,
        evidence: format!(
            "{late} of {} steps late; slowest {}",
            steps.count(),
            place_of(worst)
        ),
    })
}

/// Checks the steady-state error from T_req on.
pub(super) fn steady_error(steps: &[StepResponse], requirement: &Requirement) -> Option<Check> {
    let in_range = steps.iter().filter(|step| step.in_operating_range);
    let worst = in_range.max_by(|a, b| a.steady_error_bar.total_cmp(&b.steady_error_bar))?;
    let limit = requirement.p_tol_bar;
    Some(Check {
        id: CheckId::SteadyError,
        requirement: format!(
            "from T_req on the pressure is within {limit} bar of the reference{}",
            requirement.cite("section 1.4")
        ),
        bound: Bound::AtMost,
        limit,
        reached: Some(worst.steady_error_bar),
        unit: "bar".to_owned(),
        holds: worst.steady_error_bar <= limit + ROUNDING_BAR,
        binding: true,
        evidence: place_of(worst),
    })
}

/// Checks the overshoot.
pub(super) fn overshoot(steps: &[StepResponse], requirement: &Requirement) -> Option<Check> {
    let in_range = steps.iter().filter(|step| step.in_operating_range);
    let worst = in_range.max_by(|a, b| a.overshoot_bar.total_cmp(&b.overshoot_bar))?;
    let limit = requirement.overshoot_bar;
    Some(Check {
        id: CheckId::Overshoot,
        requirement: format!(
            "the pressure goes at most {limit} bar beyond a new reference{}",
            requirement.cite("not required; ours")
        ),
        bound: Bound::AtMost,
        limit,
        reached: Some(worst.overshoot_bar),
        unit: "bar".to_owned(),
        holds: worst.overshoot_bar <= limit + ROUNDING_BAR,
        binding: requirement.is_overshoot_binding,
        evidence: place_of(worst),
    })
}

/// Returns a place such as `2.10 to 5.96 bar at 12.00 s`.
pub(super) fn place_of(step: &StepResponse) -> String {
    format!(
        "{:.2} to {:.2} bar at {:.2} s",
        step.from_bar, step.to_bar, step.time_s
    )
}
