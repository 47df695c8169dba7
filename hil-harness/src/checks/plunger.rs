//! Motion of the regulating valve's plunger, apart from the requirements on the pressure.

use recording::{Quantity, Recording, Unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::steps::StepResponse;
use super::trajectory::Trajectory;

/// Motion of the plunger behind the chamber, which the brake torque follows (section 2.1.2). Its friction is an error of
/// the torque that no controller of the pressure corrects.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlungerMotion {
    /// Largest distance of two rest positions at one reference (mm).
    pub rest_spread_mm: f64,
    /// The same, divided by the travel of the plunger in the recording (-); 0 to 1.
    pub rest_spread_share: f64,
    /// Mean number of times that it breaks free after a step of the reference: more than 1 is stick-slip.
    pub starts_per_step: f64,
}

/// Name of the plunger's position in a recording.
pub(crate) const PLUNGER: &str = "x_plunger";

/// Returns the motion after the steps; `None` without a plunger or a step.
pub(super) fn motion(
    recording: &Recording,
    trajectory: &Trajectory,
    steps: &[StepResponse],
) -> Option<PlungerMotion> {
    let signal = recording.require(PLUNGER, Quantity::Length).ok()?;
    let position_mm = signal.values_in(Unit::Millimetre).ok()?;
    if steps.is_empty() || position_mm.len() != trajectory.len() {
        return None;
    }
    let is_moving = |index: usize| index > 0 && position_mm[index] != position_mm[index - 1];
    let during = |step: &StepResponse| step.index + 1..step.index + step.held_samples as usize;
    let starts = |step: &StepResponse| {
        let begins = |index: &usize| is_moving(*index) && !is_moving(index - 1);
        during(step).filter(begins).count()
    };
    let rest = |step: &StepResponse| {
        let last = during(step).last()?;
        (!is_moving(last)).then_some(position_mm[last])
    };
    let spread_mm = |one: &StepResponse| {
        let at_reference = steps.iter().filter(|other| other.to_bar == one.to_bar);
        extent(at_reference.filter_map(rest))
    };
    let rest_spread_mm = steps.iter().map(spread_mm).fold(0.0, f64::max);
    let travel_mm = extent(position_mm.iter().copied());
    Some(PlungerMotion {
        rest_spread_mm,
        rest_spread_share: rest_spread_mm / travel_mm.max(f64::MIN_POSITIVE),
        starts_per_step: steps.iter().map(starts).sum::<usize>() as f64 / steps.len() as f64,
    })
}

/// Returns the difference of the largest and the smallest value; 0 without values.
fn extent(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    (high - low).max(0.0)
}
