//! Intervals by the profile likelihood, where the curvature at the fit describes the cost poorly.
//!
//! An interval from the curvature assumes that the cost grows with the square of the distance from the fit. That is wrong where a valve
//! opens only below some preload, and where a range ends before the interval does. The profile is the least cost with one parameter fixed
//! and the others fitted. Its interval ends where the cost has risen by as much as the curvature predicts for the end of the other one.
//!
//! W. Q. Meeker, L. A. Escobar, Teaching about approximate confidence regions based on maximum likelihood estimation, The American
//! Statistician 49 (1995).

use rayon::prelude::*;

use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::fit::interval::covariance;
use crate::diagnosis::fit::trial::Trial;
use crate::diagnosis::fit::{Descent, Fit, Fitter};

/// Relative difference between the actual and the predicted rise at the end of an interval below which the curvature describes the cost.
const AS_PREDICTED: f64 = 0.5;
/// Relative difference between the actual and the required rise of the profile below which the end of an interval counts as found.
const FOUND: f64 = 0.2;
/// Largest number of fits of the other parameters for one end of an interval.
const FITS: usize = 6;
/// Largest ratio of the distances of two consecutive fits.
const LARGEST_RATIO: f64 = 3.0;

/// Returns the distances from each coordinate of `trial` to the lower and to the upper end of its 95 % interval. These are `widths`, the
/// half widths from the curvature, where the cost there is as the curvature predicts, and those of the profile elsewhere. The fit of
/// `trial` must be one by an accurate fitter.
pub(super) fn distances(evidence: &Evidence, trial: &Trial, widths: &[f64]) -> Vec<[f64; 2]> {
    // A model that leaves more than the noise has no likelihood.
    let covariance = covariance(evidence, trial).filter(|_| !trial.is_material());
    let Some(covariance) = covariance else {
        return widths.iter().map(|&width| [width; 2]).collect();
    };
    let of_parameter = |n: usize| {
        let variance = covariance[(n, n)];
        let along = covariance.column(n).iter().map(|c| c / variance).collect();
        let profile = Profile {
            fitter: Fitter::accurate_but_for(evidence, &trial.unknowns, n),
            fit: &trial.fit,
            n,
            along,
            curvature: variance.recip(),
        };
        [-1.0, 1.0].map(|side| profile.distance(side, widths[n]))
    };
    (0..widths.len())
        .into_par_iter()
        .map(of_parameter)
        .collect()
}

/// Least cost as a function of one coordinate.
struct Profile<'a> {
    /// Fitter of the other coordinates.
    fitter: Fitter<'a>,
    fit: &'a Fit,
    n: usize,
    /// Derivative of the fitted coordinates with respect to this one, by the curvature.
    along: Vec<f64>,
    /// Half the second derivative of the profile at the fit.
    curvature: f64,
}

impl Profile<'_> {
    /// Returns the distance to the lower (`side` -1) or upper (1) end of the interval; `width` is that from the curvature.
    fn distance(&self, side: f64, width: f64) -> f64 {
        let (least, most) = self.fitter.unknowns.list()[self.n].bounds();
        let z = self.fit.z[self.n];
        let reach = if side < 0.0 { z - least } else { most - z };
        let rise = self.curvature * width * width;
        let mut distance = width.min(reach);
        if distance <= 0.0 || self.is_as_predicted(side * distance) {
            return width;
        }
        let (mut within, mut beyond) = (0.0, f64::INFINITY);
        for _ in 0..FITS {
            let Some(reached) = self.rise_at(side * distance) else {
                return width;
            };
            if (reached / rise - 1.0).abs() < FOUND {
                return distance;
            }
            if reached < rise {
                if distance >= reach {
                    return width.max(reach);
                }
                within = distance;
            } else {
                beyond = distance;
            }
            let factor = (rise / reached.max(f64::MIN_POSITIVE)).sqrt();
            let next = distance * factor.clamp(LARGEST_RATIO.recip(), LARGEST_RATIO);
            let is_new = next > within && next < beyond;
            distance = if is_new {
                next
            } else {
                0.5 * (within + beyond)
            };
            distance = distance.min(reach);
        }
        // The end was not found exactly: the least distance that is known to be too far.
        beyond.min(reach)
    }

    /// Returns whether the cost at the distance `by` from the fit agrees with the prediction of the curvature.
    fn is_as_predicted(&self, by: f64) -> bool {
        let predicted = self.curvature * by * by;
        self.moved(by).is_some_and(|there| {
            let risen = there.cost - self.fit.cost;
            (risen / predicted - 1.0).abs() < AS_PREDICTED
        })
    }

    /// Returns the rise of the profile at the distance `by` from the fit; none if that point cannot be simulated.
    fn rise_at(&self, by: f64) -> Option<f64> {
        let start = Fit {
            jacobian: self.fit.jacobian.clone(),
            ..self.moved(by)?
        };
        let corrected = Descent::Begun {
            renews_below: f64::NEG_INFINITY,
        };
        let fitted = self.fitter.descend(start, corrected)?;
        Some(fitted.cost - self.fit.cost)
    }

    /// Returns the point at the distance `by` from the fit in this coordinate, the others moved with it by the curvature.
    fn moved(&self, by: f64) -> Option<Fit> {
        let coordinates = self.fit.z.iter().zip(&self.along);
        let moved = coordinates.zip(self.fitter.unknowns.list());
        let moved = moved.map(|((z, along), unknown)| {
            let (least, most) = unknown.bounds();
            (z + by * along).clamp(least, most)
        });
        self.fitter.at(moved.collect())
    }
}

#[cfg(test)]
mod tests {
    use plant_sim::PlantParameters;
    use plant_sim::parameters::Knowledge;

    use super::*;
    use crate::bench::Bench;
    use crate::diagnosis::estimation::bench as bench_of;
    use crate::diagnosis::evidence::unknowns::Unknowns;
    use crate::diagnosis::fit::Difference;
    use crate::diagnosis::fit::split::Split;

    /// Returns the accurate fit of a log in which only the parameters `free` are estimated, within 30 %.
    fn fitted(
        plant: &PlantParameters,
        free: &[&str],
        phases: &[(f64, f64, f64)],
    ) -> (Split, Trial) {
        let mut plant = plant.clone();
        for name in crate::diagnosis::nuisance::ordinary_names() {
            let knowledge = if free.contains(&name) {
                Knowledge::TolerancePct(30.0)
            } else {
                Knowledge::Exact
            };
            plant.knowledge.insert(name.to_owned(), knowledge);
        }
        let log = Bench {
            plant: plant.clone(),
            phases: phases.to_vec(),
            ..Bench::default()
        }
        .measure();
        let split = Split::as_given(&plant, &[log], &[]).unwrap();
        let unknowns = Unknowns::new(&plant, &[], &split.fitting.logs);
        let fitter = Fitter::accurate(&split.fitting, &unknowns);
        let mut fit = fitter.at(unknowns.start()).unwrap();
        fit = fitter.descend(fit, Descent::Whole).unwrap();
        fitter.differentiate(&mut fit, 0, Difference::Fine).unwrap();
        let trial = bench_of(&plant, &split).judge(Vec::new(), unknowns, fit);
        (split, trial.unwrap())
    }

    /// The cost of a parameter that acts linearly grows with the square of the distance, so the curvature gives the interval.
    #[test]
    fn a_linear_parameter_keeps_the_interval_of_its_curvature() {
        let phases = [(1.0, 100.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 100.0)];
        let (split, trial) = fitted(
            &PlantParameters::nominal(),
            &["flow.discharge_fill"],
            &phases,
        );
        let widths = crate::diagnosis::fit::interval::half_widths(&split.fitting, &trial);
        assert_eq!(
            distances(&split.fitting, &trial, &widths),
            [[widths[0]; 2]],
            "{widths:?}"
        );
    }

    /// With a much smaller preload the pulses would open the valve; with a larger one they do not open it either. The curvature at the fit
    /// shows neither.
    #[test]
    fn pulses_that_do_not_open_a_valve_bound_its_preload_from_below() {
        let phases = [(0.5, 0.0, 0.0), (3.0, 20.0, 0.0), (0.5, 0.0, 0.0)];
        let name = "armature.preload_fill_n";
        let (split, trial) = fitted(&PlantParameters::nominal(), &[name], &phases);
        let widths = crate::diagnosis::fit::interval::half_widths(&split.fitting, &trial);
        let [[below, above]] = distances(&split.fitting, &trial, &widths)[..] else {
            panic!("one parameter")
        };
        let (least, most) = trial.unknowns.list()[0].bounds();
        let z = trial.fit.z[0];
        assert!(below < 0.9 * (z - least), "{below} of {}", z - least);
        assert!(above >= most - z, "{above} of {}", most - z);
    }
}
