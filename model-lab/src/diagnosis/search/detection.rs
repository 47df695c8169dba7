//! Detection limit: the smallest size at which an effect shows in these logs.

use nalgebra::DVector;
use plant_sim::effects::EffectSetting;

use crate::diagnosis::evidence::effect_unknown::EffectUnknown;
use crate::diagnosis::evidence::errors::Errors;
use crate::diagnosis::evidence::unknowns::{Unknown, Unknowns};
use crate::diagnosis::fit::Fitter;
use crate::diagnosis::fit::trial::{Bench, Trial};
use crate::diagnosis::fit::vector::dot;
use crate::diagnosis::result::{DetectionLimit, FittedParameter};
use crate::diagnosis::verdict::{DETECTABLE, WORTH_SHOWING};

/// Number of typical sizes beyond which an effect counts as not excited.
const LARGEST_SIZE: f64 = 10.0;
/// First size of the search, below the typical one, where most effects are proportional to it, ...
const FIRST_SIZE: f64 = 0.3;
/// ... and number of corrections of that size.
const CORRECTIONS: usize = 2;

/// Returns the smallest size of `effect` on top of `base` that would have been named: the part that the nuisance parameters cannot absorb
/// is beyond chance (non-centrality after W. E. Saris, A. Satorra, D. Sörbom 1987) and material.
pub(crate) fn detection_limit(
    bench: &Bench,
    base: &Trial,
    effect: &EffectSetting,
) -> DetectionLimit {
    let not_excited = || DetectionLimit::NotExcited {
        test_signal: effect.effect().about().excited_by.to_owned(),
    };
    let unknowns = base.unknowns.clone().with_effect(effect);
    let own = &unknowns.list()[base.unknowns.len()..];
    let mut size = FIRST_SIZE;
    for _ in 0..=CORRECTIONS {
        let Some(visible) = visibility(bench, base, &unknowns, size) else {
            return not_excited();
        };
        if visible <= 0.0 {
            return not_excited();
        }
        size = (size / visible).clamp(0.01 * FIRST_SIZE, 1.5 * LARGEST_SIZE);
    }
    if size > LARGEST_SIZE {
        return not_excited();
    }
    let strength = own.iter().find(|unknown| unknown.is_strength());
    match strength {
        Some(unknown @ Unknown::Effect(EffectUnknown { spec, .. })) => DetectionLimit::Size {
            key: spec.key.to_owned(),
            value: unknown.value(unknown.of_size(size)),
            unit: spec.unit.to_owned(),
        },
        _ => not_excited(),
    }
}

/// Returns `limit` of an effect that explains `share` of the excess with `parameters`. An effect that shows at a size is excited at that
/// size, whatever the other effects leave of it.
pub(crate) fn excited(
    limit: DetectionLimit,
    share: f64,
    parameters: &[FittedParameter],
) -> DetectionLimit {
    let mut strengths = parameters.iter().filter(|one| one.typical.is_some());
    match (&limit, strengths.next()) {
        (DetectionLimit::NotExcited { .. }, Some(strength)) if share >= WORTH_SHOWING => {
            DetectionLimit::Size {
                key: strength.key.clone(),
                value: strength.value,
                unit: strength.unit.clone(),
            }
        }
        _ => limit,
    }
}

/// Returns the visibility of an effect of this size over the detection threshold; 1 at the limit, proportional to the size.
fn visibility(bench: &Bench, base: &Trial, unknowns: &Unknowns, size: f64) -> Option<f64> {
    let fitter = Fitter::new(bench.fitting, unknowns);
    let own = &unknowns.list()[base.unknowns.len()..];
    let mut z = base.fit.z.clone();
    z.extend(own.iter().map(|unknown| unknown.of_size(size)));
    let with = fitter.at(z)?;
    let mut change: Vec<f64> = with
        .residuals
        .iter()
        .zip(&base.fit.residuals)
        .map(|(with, without)| with - without)
        .collect();
    hide(bench, base, &mut change)?;
    let chance = (dot(&change, &change) / base.correlation_samples / DETECTABLE).sqrt();
    let errors = Errors::new(bench.fitting, &change, bench.fitting.horizon);
    Some(chance.min(errors.over_material()))
}

/// Removes the part that the parameters of `base` can imitate within their tolerances.
fn hide(bench: &Bench, base: &Trial, change: &mut [f64]) -> Option<()> {
    let fitter = Fitter::new(bench.fitting, &base.unknowns);
    let (hessian, _) = fitter.normal(&base.fit);
    let columns = &base.fit.jacobian;
    let right = DVector::from_iterator(
        columns.len(),
        columns.iter().map(|column| dot(column, change)),
    );
    let share = hessian.cholesky()?.solve(&right);
    for (column, share) in columns.iter().zip(share.iter()) {
        for (change, column) in change.iter_mut().zip(column) {
            *change -= share * column;
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Defect seen: a diagnosis called an effect not excited although it reduced the error fourfold.
    #[test]
    fn an_effect_that_explains_a_part_of_the_error_is_excited_at_its_fitted_size() {
        let unseen = || DetectionLimit::NotExcited {
            test_signal: "a hold".to_owned(),
        };
        let area = FittedParameter {
            key: "area_m2".to_owned(),
            unit: "m2".to_owned(),
            value: 3e-8,
            low: 2e-8,
            high: 4e-8,
            typical: Some(2e-8),
            at_bound: false,
        };
        let at_fitted = DetectionLimit::Size {
            key: "area_m2".to_owned(),
            value: 3e-8,
            unit: "m2".to_owned(),
        };
        assert_eq!(
            excited(unseen(), 0.75, core::slice::from_ref(&area)),
            at_fitted
        );
        assert_eq!(excited(unseen(), 0.01, &[area]), unseen());
        assert_eq!(excited(unseen(), 0.75, &[]), unseen());
    }
}
