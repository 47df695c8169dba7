//! Start of the fit of an effect.

use core::ops::RangeInclusive;

use nalgebra::{Cholesky, DVector, Dyn};

use super::vector::{dot, square};
use super::{Fit, Fitter};
use crate::diagnosis::evidence::unknowns::Unknown;

/// Sizes at which an effect is evaluated first, over the typical one; other shapes are evaluated at the typical size alone.
const SIZES: [f64; 2] = [0.15, 1.0];
/// Sizes that are evaluated where the first ones indicate them.
const WEAKER_SIZE: f64 = 0.02;
const STRONGER_SIZES: [f64; 2] = [5.0, 30.0];
/// Best share of the contribution of a size below which a weaker size is evaluated, ...
const WEAK: f64 = 0.3;
/// ... and above which a stronger one is.
const STRONG: f64 = 0.7;
/// Sizes of an effect with a sign: the first ones show whether a gain is expected.
const SIGNED_SIZES: [f64; 2] = [-0.15, 0.15];
const FURTHER_SIGNED_SIZES: [f64; 2] = [-1.0, 1.0];
/// Displacements of a parameter of form from its typical value, in standard deviations, for a look at its law elsewhere: a fit that begins
/// in the wrong valley stays there.
const SHAPES: [f64; 3] = [0.0, -0.6, 0.6];
/// Number of starts that are fitted, at most.
const BEST: usize = 3;
/// Additional cost of a shape that is not typical: the data of a poor log leave the shape undetermined.
const UNTYPICAL: f64 = 10.0;
/// Shares to which the contribution of an effect is reduced: a fit reaches those nearer to 1 by itself.
const WEAKENED: RangeInclusive<f64> = 1e-3..=0.5;
/// Shares to which that of an effect with a sign is raised where its gain is expected: a fit reaches such sizes by itself.
const STRENGTHENED: RangeInclusive<f64> = 2.0..=50.0;
/// Distance from the end of a range, in coordinates, within which a parameter is at this end.
const AT_END: f64 = 1e-6;
/// Ratio of a neighbouring size, from which the power follows with which an effect grows with its size, ...
const NEIGHBOUR: f64 = 0.8;
/// ... within these powers.
const POWERS: [f64; 2] = [0.5, 10.0];

/// Effect on top of a fitted plant, before any of its parameters is fitted.
#[derive(Clone)]
pub(crate) struct Start {
    size: f64,
    /// Displacements of the parameters of form, in their standard deviations.
    shape: Vec<f64>,
    /// Point with the nuisance parameters of the plant without the effect; no Jacobian.
    pub(crate) fit: Fit,
    /// Coordinates after the nuisance parameters adapted to the effect, ...
    pub(crate) moved: Vec<f64>,
    /// ... and the cost there according to a linear model.
    pub(crate) expected_cost: f64,
    /// Best share of its contribution, as if the residuals were linear in it.
    best: Option<BestShare>,
}

/// Effect in its typical shape on top of a fitted plant.
pub(crate) struct Prospect {
    starts: Vec<Start>,
    /// Expected decrease of the cost with the effect beyond that without it; none if no size can be simulated.
    pub(crate) gain: Option<f64>,
}

/// Evaluates a few sizes of the effect whose unknowns are the last ones, on top of `base`.
pub(crate) fn prospect(fitter: &Fitter, base: &Fit) -> Prospect {
    let own = &fitter.unknowns.list()[base.z.len()..];
    let typical = vec![0.0; own.len()];
    let is_signed = own.iter().any(Unknown::is_signed);
    let room = Room::of(fitter, base, is_signed);
    let begin = |size: f64| Start::new(fitter, &room, own, size, &typical);
    let starts = if is_signed {
        SIGNED_SIZES.into_iter().filter_map(begin).collect()
    } else {
        starts_of_sizes(room.without, begin)
    };
    let expected = starts.iter().map(|start: &Start| {
        let is_scaled = |best: &BestShare| {
            WEAKENED.contains(&best.share) || is_signed && STRENGTHENED.contains(&best.share)
        };
        let scaled = start.best.filter(is_scaled);
        scaled.map_or(start.expected_cost, |best| {
            best.cost.min(start.expected_cost)
        })
    });
    let least = expected.min_by(f64::total_cmp);
    Prospect {
        gain: least.map(|least| room.without - least),
        starts,
    }
}

/// Returns starts at the first sizes, and at those that their best shares indicate; `without` is the cost that is expected without the
/// effect.
fn starts_of_sizes(without: f64, begin: impl Fn(f64) -> Option<Start>) -> Vec<Start> {
    let mut starts: Vec<Start> = SIZES.into_iter().filter_map(&begin).collect();
    // Where the least size increases the cost beyond that of no effect, the effect is not linear up to there: it may empty a tank.
    let asks_for_weaker = |start: &Start| {
        let is_much = |best: BestShare| (0.0..WEAK).contains(&best.share);
        start.best.is_some_and(is_much) || start.expected_cost > without
    };
    if starts.first().is_none_or(asks_for_weaker) {
        starts.extend(begin(WEAKER_SIZE));
    }
    let mut least = without.min(
        starts
            .first()
            .map_or(f64::INFINITY, |start| start.expected_cost),
    );
    let mut last = starts.iter().find(|start| start.size == SIZES[1]).cloned();
    for size in STRONGER_SIZES {
        let asks_for_stronger = |start: &Start| {
            start.expected_cost < least || start.best.is_none_or(|best| best.share > STRONG)
        };
        let Some(start) = last.filter(asks_for_stronger) else {
            break;
        };
        least = least.min(start.expected_cost);
        last = begin(size);
        starts.extend(last.clone());
    }
    starts
}

/// Returns the most promising starts of the effect whose unknowns are the last ones, on top of `base`.
///
/// An effect may be far weaker than the typical one and still show. Each size therefore also gives the best share of its contribution.
/// A size of that strength is also tried if its expected cost is below that of the sizes themselves.
pub(crate) fn most_promising(fitter: &Fitter, base: &Fit, prospect: Prospect) -> Vec<Start> {
    let own = &fitter.unknowns.list()[base.z.len()..];
    let is_signed = own.iter().any(Unknown::is_signed);
    let room = Room::of(fitter, base, is_signed);
    let begin = |size: f64, shape: &[f64]| Start::new(fitter, &room, own, size, shape);
    let typical = vec![0.0; own.len()];
    let mut starts = prospect.starts;
    let whole: &[f64] = if is_signed {
        starts.extend(
            FURTHER_SIGNED_SIZES
                .into_iter()
                .filter_map(|size| begin(size, &typical)),
        );
        &FURTHER_SIGNED_SIZES
    } else {
        &SIZES[1..]
    };
    for shape in shapes(own) {
        starts.extend(whole.iter().filter_map(|&size| begin(size, &shape)));
    }
    let least = starts
        .iter()
        .map(|start| start.expected_cost)
        .fold(f64::INFINITY, f64::min);
    let weakened = starts
        .iter()
        .filter_map(|start| Some((start, start.best?)))
        .filter(|(_, best)| WEAKENED.contains(&best.share) && best.cost < least)
        .min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
    if let Some((start, best)) = weakened {
        let power = start.power(fitter, &room, own).unwrap_or(1.0);
        let size = start.size * best.share.powf(1.0 / power);
        let shape = start.shape.clone();
        starts.extend(begin(size, &shape));
    }
    let price = |start: &Start| {
        let is_typical = start.shape.iter().all(|&moved| moved == 0.0);
        start.expected_cost + if is_typical { 0.0 } else { UNTYPICAL }
    };
    let by_price = |a: &Start, b: &Start| price(a).total_cmp(&price(b));
    starts.sort_by(by_price);
    starts.truncate(BEST);
    starts
}

/// Returns the displacements of the unknowns of an effect: every combination of its parameters of form except the typical one.
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

/// Best share of a start's contribution, and the expected cost.
#[derive(Debug, Clone, Copy)]
struct BestShare {
    share: f64,
    cost: f64,
}

/// Fitted plant whose nuisance parameters adapt to an effect.
struct Room<'a> {
    base: &'a Fit,
    /// Whether each nuisance parameter stays where it is beside an effect with a sign: at the end of its range, which the fit would leave.
    is_held: Vec<bool>,
    /// Cholesky factor of the curvature; none where the curvature is singular.
    curvature: Option<Cholesky<f64, Dyn>>,
    gradient: DVector<f64>,
    /// Expected cost after a further step without the effect. Where the model is not smooth, the step may not reach it.
    without: f64,
}

impl<'a> Room<'a> {
    /// An effect with a sign adds to the signals what a parameter at the end of its range does, the ambient pressure that of an absolute
    /// pressure: this parameter must not seem to account for it.
    fn of(fitter: &Fitter, base: &'a Fit, is_signed: bool) -> Self {
        let (mut hessian, mut gradient) = fitter.normal(base);
        let (_, decrease) = fitter.step(base, 0.0);
        let list = fitter.unknowns.list().iter().zip(&base.z);
        let is_held: Vec<bool> = list
            .zip(&gradient)
            .map(|((unknown, &z), &slope)| {
                let (least, most) = unknown.bounds();
                let leaves = z - least < AT_END && slope > 0.0 || most - z < AT_END && slope < 0.0;
                is_signed && leaves
            })
            .collect();
        for n in (0..is_held.len()).filter(|&n| is_held[n]) {
            hessian.row_mut(n).fill(0.0);
            hessian.column_mut(n).fill(0.0);
            hessian[(n, n)] = 1.0;
            gradient[n] = 0.0;
        }
        Self {
            base,
            is_held,
            curvature: hessian.cholesky(),
            gradient,
            without: base.cost - decrease.max(0.0),
        }
    }

    /// Returns the best share as if the residuals were linear in `added` and in the nuisance parameters, whose part is removed first.
    fn best_share(&self, added: &[f64]) -> Option<BestShare> {
        let columns = self.base.jacobian.iter();
        let columns = columns.zip(&self.is_held);
        let shared = columns.map(|(column, is_held)| match is_held {
            true => 0.0,
            false => dot(column, added),
        });
        let shared = DVector::from_iterator(self.base.jacobian.len(), shared);
        let room = self.curvature.as_ref()?.solve(&shared);
        let along = dot(added, &self.base.residuals) - room.dot(&self.gradient);
        let across = square(added) - room.dot(&shared);
        (across > 0.0).then(|| BestShare {
            share: -along / across,
            cost: self.without - along * along / across,
        })
    }
}

impl Start {
    /// Returns the start with the strengths of the effect at `size`, its other parameters typical except for `shape`.
    fn new(
        fitter: &Fitter,
        room: &Room,
        own: &[Unknown],
        size: f64,
        shape: &[f64],
    ) -> Option<Self> {
        let mut z = room.base.z.clone();
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
        fit.jacobian.clone_from(&room.base.jacobian);
        let (moved, decrease) = fitter.step(&fit, 0.0);
        fit.jacobian = Vec::new();
        Some(Self {
            size,
            shape: shape.to_vec(),
            expected_cost: fit.cost - decrease.max(0.0),
            best: room.best_share(&added(&fit, room.base)),
            fit,
            moved,
        })
    }

    /// Returns the power of its size with which the effect grows.
    fn power(&self, fitter: &Fitter, room: &Room, own: &[Unknown]) -> Option<f64> {
        let near = Self::new(fitter, room, own, NEIGHBOUR * self.size, &self.shape)?;
        let [here, there] = [self, &near].map(|start| square(&added(&start.fit, room.base)).sqrt());
        let power = (there / here).ln() / NEIGHBOUR.ln();
        power.is_finite().then(|| power.clamp(POWERS[0], POWERS[1]))
    }
}

/// Returns the contribution of an effect to the residuals of `base`.
fn added(with: &Fit, base: &Fit) -> Vec<f64> {
    let pairs = with.residuals.iter().zip(&base.residuals);
    pairs.map(|(with, without)| with - without).collect()
}

#[cfg(test)]
mod tests {
    use plant_sim::PlantParameters;
    use plant_sim::effects::{EffectSetting, by_id};
    use plant_sim::parameters::Knowledge;

    use super::*;
    use crate::bench::{Bench, with_absolute_pressure};
    use crate::diagnosis::evidence::unknowns::Unknowns;
    use crate::diagnosis::fit::gather::gather;
    use crate::diagnosis::fit::{Descent, Difference};

    /// Defect seen: on a fit that was not at its end, the expected gain of every effect included that of a further step without it. Thirty
    /// fits of effects that did not exist were begun.
    #[test]
    fn an_effect_gets_no_credit_for_what_the_plant_gains_without_it() {
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
        let gain = |id: &str| {
            let effect = EffectSetting::typical(by_id(id).unwrap());
            let unknowns = unknowns.clone().with_effect(&effect);
            prospect(&Fitter::new(&evidence, &unknowns), &unfitted)
                .gain
                .unwrap()
        };
        let heating = gain("coil_heating");
        assert!(
            heating < 0.05 * without,
            "{heating} of {without}, which the plant gains without it"
        );
    }

    /// Defect seen: an ambient pressure at the end of its range seemed to account for the offset of a sensor of absolute pressure, and no
    /// gain was expected of the offset.
    #[test]
    fn a_value_at_the_end_of_its_range_does_not_account_for_an_offset() {
        let mut plant = PlantParameters::nominal();
        let ambient = "gas.ambient_pressure_pa".to_owned();
        plant.knowledge.insert(ambient, Knowledge::Tolerance(2e3));
        let offset = EffectSetting::typical(by_id("sensor_offset").unwrap());
        let rig = plant
            .clone()
            .with_effect(offset.clone().with("offset_bar", -0.13));
        let bench = Bench {
            plant: rig,
            ..Bench::default()
        };
        let evidence =
            gather(&plant, [&with_absolute_pressure(&bench.measure(), 1.01325)]).unwrap();
        let unknowns = Unknowns::new(&plant, &[], &evidence.logs);
        let fitter = Fitter::new(&evidence, &unknowns);
        let fit = fitter.descend(fitter.at(unknowns.start()).unwrap(), Descent::Whole);
        let fit = fit.unwrap();
        let unknowns = unknowns.with_effect(&offset);
        let gain = prospect(&Fitter::new(&evidence, &unknowns), &fit).gain;
        assert!(gain.unwrap() > 0.5 * fit.cost, "{gain:?} of {}", fit.cost);
    }
}
