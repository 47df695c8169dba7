//! Where the fit of an effect begins.

use core::ops::RangeInclusive;

use nalgebra::DVector;

use super::fit::{Fit, Fitter};
use super::unknowns::Unknown;
use super::vector::{dot, square};

/// Sizes at which the search for the best one begins, over the typical one; other shapes at the typical one alone.
const SIZES: [f64; 5] = [0.02, 0.15, 1.0, 5.0, 30.0];
/// The same for effects that have a sign.
const SIGNED_SIZES: [f64; 4] = [-1.0, -0.15, 0.15, 1.0];
/// Standard deviations by which a parameter of form is moved from its typical value, to see what its law is like
/// elsewhere: a fit that begins in the wrong valley stays there.
const SHAPES: [f64; 3] = [0.0, -0.6, 0.6];
/// So many starts are looked at where they promise to lead.
const BEST: usize = 3;
/// A shape that is not typical promises this much more: the data of a poor log leave the shape open.
const UNTYPICAL: f64 = 10.0;
/// What an effect adds is made smaller by these shares: what is nearer to 1 a fit reaches by itself.
const WEAKENED: RangeInclusive<f64> = 1e-3..=0.5;
/// A neighbouring size, to see with which power of its size an effect grows, ...
const NEIGHBOUR: f64 = 0.8;
/// ... within these powers.
const POWERS: [f64; 2] = [0.5, 10.0];

/// Sizes of an effect with a sign at which it shows whether it promises anything: others follow from these.
const FIRST_SIGNED_SIZES: [f64; 2] = [-0.15, 0.15];

/// An effect on top of a fitted plant, before anything of it is fitted.
pub(crate) struct Start {
    size: f64,
    /// Displacements of the parameters of form, in their standard deviations.
    shape: Vec<f64>,
    /// With the nuisance parameters of the plant without it.
    pub(crate) fit: Fit,
    /// Where the nuisance parameters have made room for it, ...
    pub(crate) moved: Vec<f64>,
    /// ... and the cost that a linear model promises there.
    pub(crate) promised: f64,
}

/// Returns by how much more the cost of `base` is expected to fall with the effect than without it. The unknowns of the effect are the
/// last ones; the best of a few sizes counts.
pub(crate) fn promised_gain(fitter: &Fitter, base: &Fit) -> Option<f64> {
    let own = &fitter.unknowns.list()[base.z.len()..];
    let is_signed = own.iter().any(Unknown::is_signed);
    let sizes: &[f64] = if is_signed {
        &FIRST_SIGNED_SIZES
    } else {
        &SIZES
    };
    let typical = vec![0.0; own.len()];
    let without = cost_without(fitter, base);
    let starts = sizes
        .iter()
        .filter_map(|&size| Start::new(fitter, base, own, size, &typical));
    let promised = starts.map(|start| {
        let weakened = start
            .best_share(fitter, base, without)
            .filter(|best| WEAKENED.contains(&best.share));
        weakened.map_or(start.promised, |best| best.cost.min(start.promised))
    });
    let least = promised.min_by(f64::total_cmp)?;
    Some(without - least)
}

/// Returns the expected cost after a further step of `base` without the effect. Where the model is not smooth, the step may not reach it.
fn cost_without(fitter: &Fitter, base: &Fit) -> f64 {
    let (_, decrease) = fitter.step(base, 0.0);
    base.cost - decrease.max(0.0)
}

/// The most promising starts of the effect whose unknowns are the last ones, on top of `base`.
///
/// An effect may be far weaker than is typical and still show. So each size also says how much of what it adds would be
/// best, and where that promises more than the sizes themselves, one of that strength is tried as well.
pub(crate) fn most_promising(fitter: &Fitter, base: &Fit) -> Vec<Start> {
    let own = &fitter.unknowns.list()[base.z.len()..];
    let is_signed = own.iter().any(Unknown::is_signed);
    let sizes: &[f64] = if is_signed { &SIGNED_SIZES } else { &SIZES };
    let begin =
        |fitter: &Fitter, size: f64, shape: &[f64]| Start::new(fitter, base, own, size, shape);
    let typical = vec![0.0; own.len()];
    let without = cost_without(fitter, base);
    let mut starts: Vec<Start> = sizes
        .iter()
        .filter_map(|&size| begin(fitter, size, &typical))
        .collect();
    for shape in shapes(own) {
        let sizes = sizes.iter().filter(|size| size.abs() == 1.0);
        starts.extend(sizes.filter_map(|&size| begin(fitter, size, &shape)));
    }
    let least = starts
        .iter()
        .map(|start| start.promised)
        .fold(f64::INFINITY, f64::min);
    let weakened = starts
        .iter()
        .filter_map(|start| Some((start, start.best_share(fitter, base, without)?)))
        .filter(|(_, best)| WEAKENED.contains(&best.share) && best.cost < least)
        .min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
    if let Some((start, best)) = weakened {
        let power = start.power(fitter, base, own).unwrap_or(1.0);
        let size = start.size * best.share.powf(1.0 / power);
        let shape = start.shape.clone();
        starts.extend(Start::new(fitter, base, own, size, &shape));
    }
    let price = |start: &Start| {
        let is_typical = start.shape.iter().all(|&moved| moved == 0.0);
        start.promised + if is_typical { 0.0 } else { UNTYPICAL }
    };
    let by_promise = |a: &Start, b: &Start| price(a).total_cmp(&price(b));
    starts.sort_by(by_promise);
    starts.truncate(BEST);
    starts
}

/// Displacements of the unknowns of an effect: every combination of its parameters of form but the typical one.
fn shapes(own: &[Unknown]) -> Vec<Vec<f64>> {
    let all = own.iter().fold(vec![Vec::new()], |begun, unknown| {
        let choices: &[f64] = if unknown.is_strength() {
            &[0.0]
        } else {
            &SHAPES
        };
        let choices = choices.iter();
        choices
            .flat_map(|&choice| {
                begun
                    .iter()
                    .map(move |shape| [&shape[..], &[choice]].concat())
            })
            .collect()
    });
    let is_typical = |shape: &Vec<f64>| shape.iter().all(|&moved| moved == 0.0);
    all.into_iter().filter(|shape| !is_typical(shape)).collect()
}

/// The share of what a start adds that is best, and the cost that it promises.
struct BestShare {
    share: f64,
    cost: f64,
}

impl Start {
    /// The strengths of the effect at `size`, the rest of it typical but for `shape`.
    fn new(fitter: &Fitter, base: &Fit, own: &[Unknown], size: f64, shape: &[f64]) -> Option<Self> {
        let mut z = base.z.clone();
        let displaced = own.iter().zip(shape).map(|(unknown, &moved)| {
            let (least, most) = unknown.bounds();
            let by = if unknown.is_strength() {
                0.0
            } else {
                moved * unknown.prior_sd()
            };
            (unknown.of_size(size) + by).clamp(least, most)
        });
        z.extend(displaced);
        let mut fit = fitter.at(z)?;
        fit.jacobian.clone_from(&base.jacobian);
        let (moved, decrease) = fitter.step(&fit, 0.0);
        Some(Self {
            size,
            shape: shape.to_vec(),
            promised: fit.cost - decrease.max(0.0),
            fit,
            moved,
        })
    }

    /// What the effect adds to the residuals of `base`.
    fn added(&self, base: &Fit) -> Vec<f64> {
        let pairs = self.fit.residuals.iter().zip(&base.residuals);
        pairs.map(|(with, without)| with - without).collect()
    }

    /// As if the residuals were linear in what is added and in the nuisance parameters, whose part is taken out first. A further step of
    /// `base` without the effect promises the cost `without`.
    fn best_share(&self, fitter: &Fitter, base: &Fit, without: f64) -> Option<BestShare> {
        let added = self.added(base);
        let (hessian, gradient) = fitter.normal(base);
        let columns = base.jacobian.iter();
        let shared = DVector::from_iterator(
            base.jacobian.len(),
            columns.map(|column| dot(column, &added)),
        );
        let room = hessian.cholesky()?.solve(&shared);
        let along = dot(&added, &base.residuals) - room.dot(&gradient);
        let across = square(&added) - room.dot(&shared);
        (across > 0.0).then(|| BestShare {
            share: -along / across,
            cost: without - along * along / across,
        })
    }

    /// The power of its size with which the effect grows.
    fn power(&self, fitter: &Fitter, base: &Fit, own: &[Unknown]) -> Option<f64> {
        let near = Self::new(fitter, base, own, NEIGHBOUR * self.size, &self.shape)?;
        let [here, there] = [self, &near].map(|start| square(&start.added(base)).sqrt());
        let power = (there / here).ln() / NEIGHBOUR.ln();
        power.is_finite().then(|| power.clamp(POWERS[0], POWERS[1]))
    }
}

#[cfg(test)]
mod tests {
    use plant_sim::PlantParameters;
    use plant_sim::effects::{EffectSetting, by_id};

    use super::*;
    use crate::bench::Bench;
    use crate::diagnosis::fit::Difference;
    use crate::diagnosis::gather::gather;
    use crate::diagnosis::unknowns::Unknowns;

    /// Defect seen: on a fit that was not at its end, every effect promised what a further step without it would have gained, and thirty
    /// fits of effects that were not there were begun.
    #[test]
    fn an_effect_does_not_promise_what_the_plant_gains_without_it() {
        let plant = PlantParameters::nominal();
        let mut rig = plant.clone();
        rig.set("chamber.volume_m3", 1.04 * plant.chamber.volume_m3, "test")
            .unwrap();
        let bench = Bench {
            plant: rig,
            ..Bench::default()
        };
        let evidence = gather(&plant, [&bench.measure()]).unwrap();
        let unknowns = Unknowns::new(&plant, &[], &evidence.logs);
        let fitter = Fitter::new(&evidence, &unknowns);
        let mut unfitted = fitter.at(unknowns.start()).unwrap();
        fitter
            .differentiate(&mut unfitted, 0, Difference::Forward)
            .unwrap();
        let (_, without) = fitter.step(&unfitted, 0.0);
        let promise = |id: &str| {
            let effect = EffectSetting::typical(by_id(id).unwrap());
            let unknowns = unknowns.clone().with_effect(&effect);
            promised_gain(&Fitter::new(&evidence, &unknowns), &unfitted).unwrap()
        };
        let heating = promise("coil_heating");
        assert!(
            heating < 0.05 * without,
            "{heating} of {without}, which the plant gains without it"
        );
    }
}
