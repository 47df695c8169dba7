//! Requirements that apply with every fault.

use super::{CampaignRequirement, Finding, Observation, Oracle, unless};
use crate::campaign::bounds;
use crate::requirement::Requirement;

/// Returns the violated requirements of this sample alone.
pub(super) fn broken(observation: &Observation, oracle: &Oracle) -> [Finding; 6] {
    let [fill, vent] = observation.coils;
    let coils = || format!("fill {fill:.2} %, vent {vent:.2} %");
    let requirement = Requirement::THESIS;
    let [ratio_min, ratio_max] = bounds::RESISTANCE_RATIO;
    let by_voltage = observation.voltage_factor();
    let is_allowed = |duty: f64, [min, max]: [f64; 2]| {
        let step = bounds::DUTY_STEP_PCT;
        let min = by_voltage * ratio_min * min;
        let max = (by_voltage * ratio_max * max).min(100.0);
        duty == 0.0 || (min - step..=max + step).contains(&duty)
    };
    let empties = vent >= 100.0 - bounds::DUTY_STEP_PCT;
    let is_vent_allowed = empties || is_allowed(vent, requirement.duty_vent_pct);
    let is_fill_allowed = is_allowed(fill, requirement.duty_fill_pct);
    let highest_bar = oracle.supply_bar + bounds::SUPPLY_MARGIN_BAR;
    let before = oracle.memory.coils();
    let is_increased =
        before.is_some_and(|[fill_before, _]| fill > fill_before + bounds::DUTY_STEP_PCT);
    let is_shut = fill == 0.0 && (vent == 0.0 || empties);
    let above_bar = observation
        .shown_bar()
        .zip(oracle.conditions.reference_bar(observation))
        .map(|(shown, reference)| shown - reference);
    [
        unless(
            fill == 0.0 || vent == 0.0,
            CampaignRequirement::OneCoil,
            coils,
        ),
        unless(
            is_fill_allowed && is_vent_allowed,
            CampaignRequirement::DutyLimits,
            coils,
        ),
        unless(
            observation.pressure_bar <= highest_bar,
            CampaignRequirement::BelowSupply,
            || {
                format!(
                    "{:.3} bar of a supply of {:.3} bar",
                    observation.pressure_bar, oracle.supply_bar
                )
            },
        ),
        unless(
            !oracle.conditions.is_in_doubt() || is_shut,
            CampaignRequirement::ShutInDoubt,
            || format!("code {:?} and {}", observation.sensors.pressure, coils()),
        ),
        unless(
            oracle.conditions.reference_bar(observation).is_some() || !is_increased,
            CampaignRequirement::NoIncreaseWithoutReference,
            || {
                format!(
                    "reference {:?} and {}, before {before:?}",
                    observation.sensors.reference,
                    coils()
                )
            },
        ),
        unless(
            fill == 0.0
                || !oracle.conditions.is_steady()
                || above_bar.is_none_or(|above| above <= bounds::ABOVE_REFERENCE_BAR),
            CampaignRequirement::TowardsTheReference,
            || format!("{above_bar:?} bar above the reference and {}", coils()),
        ),
    ]
}
