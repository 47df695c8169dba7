//! Second look at logs that are not explained within the ranges of the plant file.
//!
//! Ordinary parameters at the ends of their ranges suggest a first plant file, with values that are 30 % wrong. They are
//! estimated accordingly, together with the effects found so far, and the search for effects is repeated with the estimated values.
//! Statements of the file about a value still apply.

use plant_sim::PlantParameters;

use super::estimation::Estimation;
use super::known::{Known, known};
use super::result::{Diagnosis, NuisanceValue, OutsideValue, Step, StepKind, Verdict};
use super::search::assemble::{self, Answer};

/// Largest ratio of the remaining excess, estimated over given values, at which the estimated values justify a second search.
const MUCH_NEARER: f64 = 0.5;

/// Returns whether the `estimated` values, with the effects that `first` names, explain the logs so much better than those within the plant
/// file's ranges that they justify a second search.
pub(super) fn is_nearer(estimated: &Estimation, first: &Diagnosis) -> bool {
    let pair = first.error_steps.last().zip(estimated.steps.last());
    pair.is_some_and(|(first, estimated)| excess(estimated) <= MUCH_NEARER * excess(first))
}

/// Returns the mean square of the errors over their noise, minus 1, of all signals together, on training and validation data: two diagnoses
/// may have split the data differently.
fn excess(step: &Step) -> f64 {
    let of_signal = |(signal, rms): (&String, &f64)| {
        let floor = step.noise_floor.get(signal)?;
        Some(((rms / floor).powi(2) - 1.0).max(0.0))
    };
    let errors = step.fit_rms.iter().chain(&step.check_rms);
    errors.filter_map(of_signal).sum()
}

/// Returns the answer `second`, found with the `estimated` parameters, relative to `plant`, the file as given, with which `first` was
/// found; none where it explains no more.
pub(super) fn relative_to_file(
    plant: &PlantParameters,
    first: &Diagnosis,
    mut second: Diagnosis,
) -> Option<Diagnosis> {
    let left = |of: &Diagnosis| of.error_steps.last().map_or(f64::INFINITY, excess);
    if left(&second) > left(first) {
        return None;
    }
    let outside = outside(plant, &second.nuisance);
    second.verdict = match second.verdict {
        Verdict::Adequate | Verdict::PlantFileWrong if !outside.is_empty() => {
            Verdict::PlantFileWrong
        }
        Verdict::Adequate => Verdict::Adequate,
        Verdict::Found => Verdict::Found,
        _ => return None,
    };
    second.error_steps = steps(first, &second);
    second.outside = outside;
    second.sentence = assemble::sentence(&Answer::from(&second));
    for value in &mut second.nuisance {
        let of_file = first.nuisance.iter().find(|there| there.name == value.name);
        let given = plant.get(&value.name).unwrap_or(value.datasheet);
        // Values that the first search treated as exact stayed as given.
        (value.datasheet, value.tolerance, value.plain) = of_file
            .map_or((given, 0.0, given), |there| {
                (there.datasheet, there.tolerance, there.plain)
            });
        let is_outside = second.outside.iter().any(|there| there.name == value.name);
        value.alarm = is_outside.then(|| assemble::OUTSIDE.to_owned());
    }
    second
        .location
        .of_compare
        .clone_from(&first.location.of_compare);
    Some(second)
}

/// Returns the error steps: those of the file as given, the estimated parameters, and each effect with them.
fn steps(first: &Diagnosis, second: &Diagnosis) -> Vec<Step> {
    let of_file = |step: &&Step| {
        matches!(
            step.kind,
            StepKind::PlantAsGiven | StepKind::ParametersRefitted
        )
    };
    let begin = second
        .error_steps
        .iter()
        .rposition(|step| step.added.is_none())
        .unwrap_or(0);
    let mut beyond = second.error_steps[begin..].to_vec();
    if let Some(estimated) = beyond.first_mut() {
        estimated.kind = StepKind::RangesWidened;
    }
    let of_file = first.error_steps.iter().filter(of_file).cloned();
    of_file.chain(beyond).collect()
}

/// Returns the values whose whole interval lies outside the range of `plant`.
fn outside(plant: &PlantParameters, values: &[NuisanceValue]) -> Vec<OutsideValue> {
    let outside = |value: &NuisanceValue| {
        let (least, most) = match known(plant, &value.name)? {
            Known::Stated { within, .. } => within,
            Known::Bare {
                usual: Some(usual), ..
            } => usual,
            // The value is coupled to another one.
            Known::Bare {
                together_with: Some(_),
                ..
            }
            | Known::Size => return None,
            Known::Bare { .. } | Known::Exact => {
                plant.get(&value.name).map(|exact| (exact, exact))?
            }
        };
        let is_outside = value.low > most || value.high < least;
        is_outside.then(|| OutsideValue {
            name: value.name.clone(),
            unit: value.unit.clone(),
            value: value.fitted,
            least,
            most,
        })
    };
    values.iter().filter_map(outside).collect()
}

#[cfg(test)]
mod tests {
    use core::ops::ControlFlow;

    use plant_sim::effects::{EffectSetting, by_id};

    use super::*;
    use crate::bench::Bench;
    use crate::diagnosis::{diagnose_with, diagnose_within};

    /// Defect seen: an answer that the second look did not change omitted the cost of the second look, more than half of the time.
    #[test]
    fn the_cost_contains_a_second_look_that_changes_nothing() {
        let plant = PlantParameters::nominal();
        let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
        let mut rig = plant.with_effect(leak.with("area_m2", 2e-8));
        rig.flow.discharge_fill *= 0.8;
        let log = [Bench {
            plant: rig,
            ..Bench::default()
        }
        .measure()];
        let watch = |_| ControlFlow::Continue(());
        let first = diagnose_within(&[], &plant, &log, &[], &watch).unwrap();
        assert!(first.is_held_back, "{}", first.diagnosis.sentence);
        let whole = diagnose_with(&[], &plant, &log, &[], &watch).unwrap();
        assert_eq!(whole.sentence, first.diagnosis.sentence);
        assert!(
            whole.cost.simulations > first.diagnosis.cost.simulations + 100,
            "{} and {}",
            whole.cost.simulations,
            first.diagnosis.cost.simulations
        );
    }
}
