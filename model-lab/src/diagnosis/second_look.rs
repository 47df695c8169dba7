//! The second look at logs that are not explained within what the plant file admits.
//!
//! Where ordinary parameters came to the end of their ranges, the file may be a first one, whose values are 30 % off: they are
//! estimated as such beside the effects found so far, and effects are looked for anew beside the estimated values. What the file
//! states of a value still holds.

use plant_sim::PlantParameters;

use super::assemble;
use super::estimation::Estimation;
use super::known::{Known, known};
use super::result::{Diagnosis, NuisanceValue, OutsideValue, Step, StepKind, Verdict};

/// Estimated values are another file's if they leave at most this share of what the given one leaves over the noise.
const MUCH_NEARER: f64 = 0.5;

/// Whether the `estimated` values, with the effects that `first` names, are so much nearer to the logs than those within the plant
/// file's ranges that they are worth a search of their own.
pub(super) fn is_nearer(estimated: &Estimation, first: &Diagnosis) -> bool {
    let pair = first.ladder.last().zip(estimated.steps.last());
    pair.is_some_and(|(first, estimated)| excess(estimated) <= MUCH_NEARER * excess(first))
}

/// Mean square of the errors over their noise, beyond 1, all signals together, on the fitted logs and on what was held out: two
/// diagnoses may have shared them out otherwise.
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
    let left = |of: &Diagnosis| of.ladder.last().map_or(f64::INFINITY, excess);
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
    second.ladder = steps(first, &second);
    second.outside = outside;
    second.sentence = assemble::sentence(
        second.verdict,
        &second.ladder,
        (&second.candidates, &second.outside, &second.rival_effects),
        &second.equivalents,
        second.is_converged,
    );
    for value in &mut second.nuisance {
        let of_file = first.nuisance.iter().find(|there| there.name == value.name);
        let given = plant.get(&value.name).unwrap_or(value.datasheet);
        // What the first search took as exact stayed as given.
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

/// The error steps: those of the file as given, the estimated parameters, and each effect beside them.
fn steps(first: &Diagnosis, second: &Diagnosis) -> Vec<Step> {
    let of_file = |step: &&Step| {
        matches!(
            step.kind,
            StepKind::PlantAsGiven | StepKind::ParametersRefitted
        )
    };
    let begin = second
        .ladder
        .iter()
        .rposition(|step| step.added.is_none())
        .unwrap_or(0);
    let mut beyond = second.ladder[begin..].to_vec();
    if let Some(estimated) = beyond.first_mut() {
        estimated.kind = StepKind::RangesWidened;
    }
    let of_file = first.ladder.iter().filter(of_file).cloned();
    of_file.chain(beyond).collect()
}

/// The values of which the whole interval lies outside of what `plant` admits.
fn outside(plant: &PlantParameters, values: &[NuisanceValue]) -> Vec<OutsideValue> {
    let outside = |value: &NuisanceValue| {
        let (least, most) = match known(plant, &value.name)? {
            Known::Stated { within, .. } => within,
            Known::Bare {
                usual: Some(usual), ..
            } => usual,
            // It goes with another one.
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

    /// Defect seen: an answer that the second look did not change left out what the second look cost, more than half of the time.
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
