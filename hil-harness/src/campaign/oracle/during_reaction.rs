//! Check that the fault reaction is carried out.

use super::condition::Watch;
use super::fault_reaction::FaultReaction;
use super::{CampaignRequirement, Finding, Observation, Oracle, unless};
use crate::campaign::bounds;

/// Returns the violated requirements of the fault reactions.
pub(super) fn broken(observation: &Observation, oracle: &Oracle) -> Vec<Finding> {
    let [fill, vent] = observation.coils;
    let answered: Vec<&Watch> = oracle.conditions.answered().collect();
    let said = |watches: &[&Watch]| {
        let names: Vec<String> = watches
            .iter()
            .map(|watch| format!("{:?}", watch.condition))
            .collect();
        format!(
            "{} at {:.3} bar: fill {fill:.2} %, vent {vent:.2} %",
            names.join(", "),
            observation.pressure_bar
        )
    };
    let mut findings = vec![unless(
        fill == 0.0 || answered.is_empty(),
        CampaignRequirement::NoFillAfterN,
        || said(&answered),
    )];
    // A reaction that switches off at once applies with any other fault.
    let is_off = fill == 0.0 && vent == 0.0;
    let at_once: Vec<&Watch> = answered
        .iter()
        .copied()
        .filter(|watch| {
            matches!(watch.reaction(), FaultReaction::Off | FaultReaction::Lock)
                && watch.answered_for().is_some()
        })
        .collect();
    findings.push(unless(
        is_off || at_once.is_empty(),
        CampaignRequirement::SafeInTime,
        || said(&at_once),
    ));
    if let Some(only) = oracle.conditions.only() {
        findings.extend(of_one(observation, oracle, only));
    }
    findings
}

/// Checks the reaction to the only fault.
fn of_one(observation: &Observation, oracle: &Oracle, watch: &Watch) -> Vec<Finding> {
    let [fill, vent] = observation.coils;
    let reaction = watch.reaction();
    let said = |then_bar: Option<f64>| {
        move || {
            let then = then_bar.map_or(String::new(), |bar| format!(" from {bar:.3} bar"));
            format!(
                "{:?}: {:.3} bar{then}, fill {fill:.2} %, vent {vent:.2} %",
                watch.condition, observation.pressure_bar
            )
        }
    };
    let Some(samples) = watch.answered_for() else {
        return Vec::new();
    };
    let is_off = fill == 0.0 && vent == 0.0;
    let is_over = samples >= reaction.samples();
    let mut findings = vec![unless(
        is_off || !is_over,
        CampaignRequirement::SafeInTime,
        said(None),
    )];
    if is_over && reaction.empties() && oracle.leaves_venting {
        findings.push(unless(
            observation.pressure_bar <= bounds::EMPTY_BAR,
            CampaignRequirement::EmptyInTime,
            said(None),
        ));
    }
    let is_followed = oracle.is_plain && watch.is_first();
    if reaction == FaultReaction::Hold && is_followed && samples + 1 < bounds::HOLD_SAMPLES {
        findings.push(unless(is_off, CampaignRequirement::Held, said(None)));
    }
    // A task that runs too rarely vents for longer than intended; this cannot be avoided without a sample in between.
    let is_in_time = observation.sensors.elapsed_us <= bounds::ELAPSED_MAX_US;
    if is_followed && is_in_time {
        findings.extend(of_the_pressure(
            observation,
            oracle,
            reaction,
            samples,
            &said,
        ));
    }
    findings
}

/// Checks the pressure during a reaction, if only the valves move it.
fn of_the_pressure<E: FnOnce() -> String>(
    observation: &Observation,
    oracle: &Oracle,
    reaction: FaultReaction,
    samples: u32,
    said: &dyn Fn(Option<f64>) -> E,
) -> Vec<Finding> {
    let then_bar = |window: u32| {
        // Changes by the valves before the reaction do not count.
        let is_within = samples >= window + bounds::SETTLING;
        oracle.memory.pressure_bar(window).filter(|_| is_within)
    };
    let mut findings = Vec::new();
    if let Some(then_bar) = then_bar(bounds::PULSE_PERIOD) {
        let is_risen = observation.pressure_bar > then_bar + bounds::RISE_BAR;
        findings.push(unless(
            !is_risen,
            CampaignRequirement::NoRiseAfterN,
            said(Some(then_bar)),
        ));
        let ambient_bar = 1.01325;
        let is_kept = observation.pressure_bar + ambient_bar
            >= (1.0 - bounds::PULSE_SHARE) * (then_bar + ambient_bar);
        let is_pulsed = matches!(reaction, FaultReaction::Release | FaultReaction::Hold);
        findings.push(unless(
            is_kept || !is_pulsed,
            CampaignRequirement::NoSuddenLoss,
            said(Some(then_bar)),
        ));
    }
    if let Some(then_bar) =
        then_bar(bounds::RAMP_WINDOW).filter(|_| reaction == FaultReaction::Ramp)
    {
        let most_bar =
            f64::from(bounds::RAMP_WINDOW) * bounds::RAMP_BAR_PER_SAMPLE + bounds::RAMP_MARGIN_BAR;
        // A driver who lowers the reference may get the lower pressure at once.
        let is_asked = oracle.conditions.last_reference_bar() < then_bar - bounds::LIVE_BAR;
        let is_led = observation.pressure_bar >= then_bar - most_bar;
        findings.push(unless(
            is_led || is_asked,
            CampaignRequirement::NoSuddenLoss,
            said(Some(then_bar)),
        ));
    }
    findings
}
