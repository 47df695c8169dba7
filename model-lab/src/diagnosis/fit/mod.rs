//! Least squares within bounds, with a prior of the nuisance parameters: Gauss-Newton steps, damped after Marquardt, on an active set of
//! bounds.
//!
//! A general library is not used, because none offers all three requirements: bounds, reuse of known Jacobian columns (those of the
//! nuisance parameters hardly change from one candidate to the next), and an early end for a candidate without a chance.

pub(crate) mod gather;
pub(crate) mod interval;
pub(crate) mod logger_time;
pub(crate) mod soundness;
pub(crate) mod split;
pub(crate) mod start;
pub(crate) mod supply;
pub(crate) mod trial;
pub(crate) mod vector;

use core::ops::Range;

use nalgebra::{DMatrix, DVector};
use plant_sim::Tolerance;
use rayon::prelude::*;

use super::evidence::Evidence;
use super::evidence::log::Residuals;
use super::evidence::unknowns::{Unknown, Unknowns};
use crate::measured::is_current;
use crate::result::Horizon;
use vector::{dot, square};

/// Largest number of iterations of a fit that is only begun, and of a whole one.
const FIRST_ITERATIONS: usize = 5;
const ITERATIONS: usize = 30;
/// Tolerance of simulations for intervals, over the default one, ...
const ACCURATE: f64 = 0.02;
/// ... and their difference steps, over those of a forward difference.
const FINE: f64 = 0.25;
/// Smallest expected or reached decrease of the cost that counts, absolute and as a share of this cost.
const CONVERGED: f64 = 0.5;
const CONVERGED_SHARE: f64 = 1e-4;
/// Smallest decrease that counts in a search, as a share of the cost that the noise does not explain.
const CONVERGED_EXCESS_SHARE: f64 = 5e-3;
/// Share of the cost unexplained by the noise; a fit has not converged if a further step, damped by one of these factors, gains this share.
const UNCONVERGED_EXCESS_SHARE: f64 = 0.1;
const STEP_DAMPINGS: [f64; 3] = [0.0, 1e-2, 1.0];
/// Longest step in each coordinate, ...
const LONGEST_STEP: f64 = 1.5;
/// ... and the same with a robust loss: the distance is long, and the model far from linear.
const LONGEST_FORGIVING_STEP: f64 = 0.75;
/// Relative difference between the actual and the expected decrease of the cost, to either side, that makes the Jacobian stale: with a
/// Jacobian that is too large, all steps stay short.
const STALE: f64 = 0.3;
/// Share of the last expected decrease above which the next one also makes the Jacobian stale.
const SLOW: f64 = 0.3;
/// Number of steps that correct a Jacobian before it is recomputed for being stale.
const SECANTS: usize = 3;
/// Shortest step that corrects a Jacobian: the solver's error dominates a shorter one and would be mistaken for information.
const SHORTEST_SECANT: f64 = 0.1;
/// Longest difference, as a share of the distance to the next jump of the error.
const ROOM: f64 = 0.9;
/// Number of jumps of the error on either side behind which a fit looks, and number of times that it finds less there.
const JUMPS: usize = 2;
const CROSSINGS: usize = 8;
/// Number of rows whose products are summed at a time: their columns stay in a core's cache.
const BLOCK: usize = 512;

/// Point of the unknowns with its residuals.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    pub(crate) z: Vec<f64>,
    /// Sum of squared residuals plus that of the prior.
    pub(crate) cost: f64,
    pub(crate) residuals: Residuals,
    /// Jacobian with one column per unknown: d residual / d z.
    pub(crate) jacobian: Vec<Residuals>,
}

impl Fit {
    /// Returns the point `next` with this Jacobian, corrected in the direction of the step by the observed change of the residuals, if the
    /// step was long enough.
    ///
    /// C. G. Broyden, A class of methods for solving nonlinear simultaneous equations, Mathematics of Computation 19 (1965).
    fn moved_to(self, mut next: Self) -> Self {
        let step: Vec<f64> = next
            .z
            .iter()
            .zip(&self.z)
            .map(|(to, from)| to - from)
            .collect();
        next.jacobian = self.jacobian;
        let square_length = square(&step);
        if square_length < SHORTEST_SECANT * SHORTEST_SECANT {
            return next;
        }
        let mut missed: Residuals = next
            .residuals
            .iter()
            .zip(&self.residuals)
            .map(|(to, from)| to - from)
            .collect();
        for (column, step) in next.jacobian.iter().zip(&step) {
            missed
                .iter_mut()
                .zip(column)
                .for_each(|(missed, slope)| *missed -= slope * step);
        }
        for (column, step) in next.jacobian.iter_mut().zip(&step) {
            column
                .iter_mut()
                .zip(&missed)
                .for_each(|(slope, missed)| *slope += missed * step / square_length);
        }
        next
    }
}

/// Type of the differences for a Jacobian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Difference {
    /// One-sided: sufficient for descent.
    Forward,
    /// Two-sided: the contribution of the curvature cancels.
    Central,
    /// Two-sided with a small step, so that pulses at the threshold of opening respond in proportion: directions that the logs leave
    /// undetermined stay undetermined. Only for a fitter that simulates accurately.
    Fine,
}

/// Extent of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Descent {
    /// A few steps. Existing columns of the Jacobian are recomputed only once the cost is below `renews_below`: a fit that gains nothing
    /// does not justify the computing time.
    Begun { renews_below: f64 },
    /// Descent to the least cost, where a freshly computed Jacobian predicts no further decrease.
    Whole,
}

impl Descent {
    fn iterations(self) -> usize {
        match self {
            Self::Begun { .. } => FIRST_ITERATIONS,
            Self::Whole => ITERATIONS,
        }
    }
}

/// Evaluation and descent.
pub(crate) struct Fitter<'a> {
    pub(crate) evidence: &'a Evidence,
    pub(crate) unknowns: &'a Unknowns,
    tolerance: Tolerance,
    pub(crate) horizon: Horizon,
    /// Steps of forward differences, over the usual ones.
    pub(crate) step_scale: f64,
    /// Smallest decrease that counts, as a share of the cost, ...
    pub(crate) converged_share: f64,
    /// ... and as a share of the cost that the noise does not explain.
    pub(crate) converged_excess_share: f64,
    /// Loss of the residuals.
    pub(crate) loss: Loss,
    /// Unknowns and signals that take part.
    pub(crate) scope: Scope,
    /// Observer of each point that a whole descent reaches.
    pub(crate) on_step: Option<OnStep<'a>>,
    /// Index of an unknown that is fixed.
    fixed: Option<usize>,
}

/// Observer of the points of a descent.
pub(crate) type OnStep<'a> = &'a (dyn Fn(&Fit) + Sync);

/// Part of the plant that a fit covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// All unknowns, fitted to all signals.
    Whole,
    /// Coils, delay and clocks, fitted to the currents: the currents determine them however wrong the rest of the plant is.
    Coils,
}

impl Scope {
    fn moves(self, unknown: &Unknown) -> bool {
        self == Self::Whole || unknown.is_shown_by_currents()
    }

    fn counts(self, signal: &str) -> bool {
        self == Self::Whole || is_current(signal)
    }
}

/// Loss of the residuals of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Loss {
    /// Square of the residual.
    Square,
    /// Pseudo-Huber: quadratic up to about this size, and linear beyond it.
    ///
    /// A. Charbonnier, L. Blanc-Féraud, G. Aubert, M. Barlaud, Deterministic edge-preserving regularization in computed imaging,
    /// IEEE Transactions on Image Processing 6 (1997).
    Forgiving(f64),
}

impl Loss {
    fn sum(self, residuals: &[f64]) -> f64 {
        match self {
            Self::Square => square(residuals),
            Self::Forgiving(scale) => {
                let over = |residual: &f64| (1.0 + (residual / scale).powi(2)).sqrt() - 1.0;
                2.0 * scale * scale * residuals.iter().map(over).sum::<f64>()
            }
        }
    }

    fn longest_step(self) -> f64 {
        match self {
            Self::Square => LONGEST_STEP,
            Self::Forgiving(_) => LONGEST_FORGIVING_STEP,
        }
    }

    /// Returns the weights with which squares touch the loss from above: a step with them never overshoots a linear model. None where all
    /// are 1.
    fn weights(self, residuals: &[f64]) -> Option<Vec<f64>> {
        let Self::Forgiving(scale) = self else {
            return None;
        };
        let weight = |residual: &f64| (1.0 + (residual / scale).powi(2)).sqrt().recip();
        Some(residuals.iter().map(weight).collect())
    }
}

impl<'a> Fitter<'a> {
    pub(crate) fn new(evidence: &'a Evidence, unknowns: &'a Unknowns) -> Self {
        Self {
            evidence,
            unknowns,
            tolerance: Tolerance::default(),
            horizon: evidence.horizon,
            step_scale: 1.0,
            converged_share: CONVERGED_SHARE,
            converged_excess_share: 0.0,
            loss: Loss::Square,
            scope: Scope::Whole,
            on_step: None,
            fixed: None,
        }
    }

    /// Returns a fitter for a search, where a fit that stays far above the noise need not be accurate.
    pub(crate) fn for_search(evidence: &'a Evidence, unknowns: &'a Unknowns) -> Self {
        Self {
            converged_excess_share: CONVERGED_EXCESS_SHARE,
            ..Self::new(evidence, unknowns)
        }
    }

    /// Returns a fitter that simulates so accurately that the solver's error is negligible against a difference.
    pub(crate) fn accurate(evidence: &'a Evidence, unknowns: &'a Unknowns) -> Self {
        Self {
            tolerance: Tolerance::scaled(ACCURATE),
            ..Self::new(evidence, unknowns)
        }
    }

    /// Returns an accurate fitter that moves every unknown but `n`.
    pub(crate) fn accurate_but_for(
        evidence: &'a Evidence,
        unknowns: &'a Unknowns,
        n: usize,
    ) -> Self {
        Self {
            fixed: Some(n),
            ..Self::accurate(evidence, unknowns)
        }
    }

    fn residuals(&self, z: &[f64]) -> Option<Residuals> {
        let plant = self.unknowns.plant(z);
        plant.check().ok()?;
        let mut conditions = self.evidence.conditions();
        self.unknowns.conditions(z, &mut conditions);
        let mut residuals =
            self.evidence
                .residuals_on(&plant, &conditions, self.horizon, self.tolerance)?;
        let left_out = self.evidence.channels();
        for (_, _, range) in left_out.filter(|(_, channel, _)| !self.scope.counts(channel.signal)) {
            residuals[range].fill(0.0);
        }
        Some(residuals)
    }

    fn cost(&self, z: &[f64], residuals: &Residuals) -> f64 {
        self.loss.sum(residuals) + self.prior(z)
    }

    fn prior(&self, z: &[f64]) -> f64 {
        self.unknowns
            .list()
            .iter()
            .zip(z)
            .map(|(unknown, z)| ((z - unknown.prior_mean()) / unknown.prior_sd()).powi(2))
            .sum()
    }

    /// Returns the point at `z`, without its Jacobian.
    pub(crate) fn at(&self, z: Vec<f64>) -> Option<Fit> {
        let residuals = self.residuals(&z)?;
        Some(Fit {
            cost: self.cost(&z, &residuals),
            z,
            residuals,
            jacobian: Vec::new(),
        })
    }

    /// Returns the column of the Jacobian for unknown `n` at `fit`; away from the end of a range.
    fn column(&self, fit: &Fit, n: usize, difference: Difference) -> Option<Residuals> {
        let unknown = &self.unknowns.list()[n];
        if !self.scope.moves(unknown) {
            return Some(vec![0.0; fit.residuals.len()]);
        }
        let (least, most) = unknown.smooth_range(fit.z[n]);
        let moved = |step: f64| {
            let mut z = fit.z.clone();
            z[n] += step;
            self.residuals(&z)
        };
        let step = match difference {
            Difference::Forward => self.step_scale * unknown.step(),
            Difference::Central => unknown.wide_step(),
            Difference::Fine => FINE * unknown.step(),
        };
        let room = (most - fit.z[n]).max(fit.z[n] - least);
        let step = step.min(ROOM * room);
        let has_above = fit.z[n] + step <= most;
        let has_below = fit.z[n] - step >= least;
        if difference != Difference::Forward && has_above && has_below {
            let (above, below) = (moved(step)?, moved(-step)?);
            let pairs = above.iter().zip(&below);
            return Some(
                pairs
                    .map(|(above, below)| (above - below) / (2.0 * step))
                    .collect(),
            );
        }
        let away = |step: f64| {
            let moved = moved(step)?;
            let pairs = moved.iter().zip(&fit.residuals);
            Some(pairs.map(|(moved, here)| (moved - here) / step).collect())
        };
        let first = if has_above || !has_below { step } else { -step };
        away(first).or_else(|| away(-first))
    }

    /// Fills in the columns from `first` on, each by its own simulations.
    pub(crate) fn differentiate(
        &self,
        fit: &mut Fit,
        first: usize,
        difference: Difference,
    ) -> Option<()> {
        fit.jacobian.truncate(first);
        let missing = fit.jacobian.len()..self.unknowns.len();
        let columns = missing
            .into_par_iter()
            .map(|n| self.column(fit, n, difference));
        let columns = columns.collect::<Option<Vec<_>>>()?;
        fit.jacobian.extend(columns);
        Some(())
    }

    /// Descends from `fit`, whose Jacobian may be of another point and lack the last columns, and a whole descent also behind jumps of the
    /// error and with other clocks; none where the simulation was aborted.
    pub(crate) fn descend(&self, fit: Fit, descent: Descent) -> Option<Fit> {
        let mut fit = self.follow_slopes(fit, descent)?;
        if descent != Descent::Whole {
            return Some(fit);
        }
        for _ in 0..CROSSINGS {
            let other = self.best_other_descent(&fit);
            let other = other.filter(|next| fit.cost - next.cost > self.converged(fit.cost));
            let Some(next) = other else {
                break;
            };
            fit = self.follow_slopes(next, descent)?;
        }
        Some(fit)
    }

    /// Returns the best of the fits that begin behind the next jumps of the error, or with other clocks; none where there are neither.
    fn best_other_descent(&self, fit: &Fit) -> Option<Fit> {
        let begun = Descent::Begun {
            renews_below: f64::NEG_INFINITY,
        };
        let of_clocks = self.unknowns.other_clocks(&fit.z);
        let starts: Vec<_> = self.starts_behind_jumps(fit).chain(of_clocks).collect();
        let descents = starts.into_par_iter().filter_map(|z| {
            let mut start = self.at(z)?;
            start.jacobian.clone_from(&fit.jacobian);
            self.follow_slopes(start, begun)
        });
        descents.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// Returns the points beside `fit` that lie between the next jumps of the error, with the other coordinates unchanged.
    fn starts_behind_jumps<'b>(&'b self, fit: &'b Fit) -> impl Iterator<Item = Vec<f64>> + 'b {
        let moved = self.unknowns.list().iter().enumerate();
        let moved =
            moved.filter(|&(n, unknown)| self.scope.moves(unknown) && self.fixed != Some(n));
        moved.flat_map(move |(n, unknown)| {
            let behind = unknown.behind_jumps(fit.z[n], JUMPS);
            behind.into_iter().map(move |there| {
                let mut z = fit.z.clone();
                z[n] = there;
                z
            })
        })
    }

    /// Descends from `fit` along slopes.
    fn follow_slopes(&self, mut fit: Fit, descent: Descent) -> Option<Fit> {
        let known = fit.jacobian.len();
        let mut fresh = known == 0;
        if known < self.unknowns.len() {
            self.differentiate(&mut fit, known, Difference::Forward)?;
        }
        let mut damping = 1e-3;
        let mut secants = 0;
        for _ in 0..descent.iterations() {
            let (z, expected) = self.step(&fit, damping);
            let mut renew = expected < self.converged(fit.cost);
            if renew && (fresh || descent != Descent::Whole) {
                break;
            }
            let next = if renew { None } else { self.at(z) };
            let reached = next
                .as_ref()
                .map_or(f64::NEG_INFINITY, |next| fit.cost - next.cost);
            if let Some(next) = next.filter(|_| reached > 0.0) {
                fit = fit.moved_to(next);
                // Begun descents run beside each other, from points that may be dropped.
                if let Some(on_step) = self.on_step.filter(|_| descent == Descent::Whole) {
                    on_step(&fit);
                }
                damping = (damping * 0.2).max(1e-6);
                if fresh && reached < self.converged(fit.cost) {
                    break;
                }
                fresh = false;
                secants += 1;
                let (_, further) = self.step(&fit, damping);
                let is_stale =
                    (reached - expected).abs() > STALE * expected || further > SLOW * expected;
                renew = is_stale && secants >= SECANTS;
            } else if fresh {
                damping = (damping * 10.0).max(1e-2);
                if damping > 1e4 {
                    break;
                }
            } else {
                renew = true;
            }
            if renew {
                let first = match descent {
                    Descent::Begun { renews_below } if fit.cost >= renews_below => known,
                    _ => 0,
                };
                self.differentiate(&mut fit, first, Difference::Forward)?;
                (fresh, secants) = (true, 0);
            }
        }
        Some(fit)
    }

    fn converged(&self, cost: f64) -> f64 {
        CONVERGED
            .max(self.converged_share * cost)
            .max(self.converged_excess_share * self.excess(cost))
    }

    /// Returns the part of a cost that the noise does not explain.
    fn excess(&self, cost: f64) -> f64 {
        (cost - self.evidence.counted_samples()).max(0.0)
    }

    /// Returns whether a further step from `fit`, which has its own Jacobian, gains little compared with the remaining excess. Where the
    /// model is not smooth, the expected gain of a step may be large and its actual gain zero.
    pub(crate) fn is_converged(&self, fit: &Fit) -> bool {
        let cost = self.cost(&fit.z, &fit.residuals);
        let share = UNCONVERGED_EXCESS_SHARE * self.excess(cost);
        let little = self.converged(cost).max(share);
        STEP_DAMPINGS.into_iter().all(|damping| {
            let (z, expected) = self.step(fit, damping);
            expected <= little || self.at(z).is_none_or(|next| cost - next.cost <= little)
        })
    }

    /// Returns the damped step from `fit` within the bounds, and the decrease of a linear model's cost.
    pub(crate) fn step(&self, fit: &Fit, damping: f64) -> (Vec<f64>, f64) {
        let (hessian, gradient) = self.normal(fit);
        // Unknowns without a column do not move.
        let count = fit.jacobian.len();
        let bounds: Vec<_> = self
            .unknowns
            .list()
            .iter()
            .map(|unknown| unknown.bounds())
            .collect();
        let list = self.unknowns.list();
        let mut free: Vec<usize> = (0..count)
            .filter(|&n| self.scope.moves(&list[n]) && self.fixed != Some(n))
            .collect();
        let mut step = vec![0.0; count];
        // Each pass fixes the unknowns that would leave their bounds and solves for the rest again.
        for _ in 0..=count {
            let moved = |n: usize| !free.contains(&n);
            let size = free.len();
            let matrix = DMatrix::from_fn(size, size, |a, b| {
                let value = hessian[(free[a], free[b])];
                if a == b {
                    value * (1.0 + damping) + 1e-12
                } else {
                    value
                }
            });
            let right = DVector::from_fn(size, |a, _| {
                let fixed: f64 = (0..count)
                    .filter(|&n| moved(n))
                    .map(|n| hessian[(free[a], n)] * step[n])
                    .sum();
                -gradient[free[a]] - fixed
            });
            let Some(cholesky) = matrix.cholesky() else {
                break;
            };
            let solution = cholesky.solve(&right);
            let mut outside = Vec::new();
            for (a, &n) in free.iter().enumerate() {
                let (least, most) = bounds[n];
                let longest = self.loss.longest_step();
                // A fit may begin outside the bounds: it steps towards them.
                let low = (least - fit.z[n]).clamp(-longest, longest);
                let high = (most - fit.z[n]).clamp(-longest, longest);
                step[n] = solution[a].clamp(low, high);
                if step[n] != solution[a] {
                    outside.push(n);
                }
            }
            if outside.is_empty() {
                break;
            }
            free.retain(|n| !outside.contains(n));
            if free.is_empty() {
                break;
            }
        }
        let s = DVector::from_vec(step.clone());
        let expected = -2.0 * gradient.dot(&s) - s.dot(&(&hessian * &s));
        let mut z = fit.z.clone();
        z.iter_mut().zip(&step).for_each(|(z, step)| *z += step);
        (z, expected)
    }

    /// Returns JᵀJ and Jᵀr with the prior.
    pub(crate) fn normal(&self, fit: &Fit) -> (DMatrix<f64>, DVector<f64>) {
        let columns = &fit.jacobian;
        let list = self.unknowns.list();
        let weights = self.loss.weights(&fit.residuals);
        let rows = fit.residuals.len();
        let blocks = (0..rows.div_ceil(BLOCK)).into_par_iter().map(|block| {
            let block = block * BLOCK..((block + 1) * BLOCK).min(rows);
            let weights = weights.as_ref().map(|weights| &weights[block.clone()]);
            normal_of_block(fit, block, weights)
        });
        // The sum must not depend on the number of cores.
        let blocks: Vec<_> = blocks.collect();
        let mut hessian = DMatrix::zeros(columns.len(), columns.len());
        let mut gradient = DVector::zeros(columns.len());
        for (of_hessian, of_gradient) in blocks {
            hessian += of_hessian;
            gradient += of_gradient;
        }
        for (n, unknown) in list.iter().enumerate().take(columns.len()) {
            let weight = unknown.prior_sd().powi(-2);
            hessian[(n, n)] += weight;
            gradient[n] += weight * (fit.z[n] - unknown.prior_mean());
        }
        (hessian, gradient)
    }
}

/// Returns JᵀJ and Jᵀr of some rows, each row times its weight.
fn normal_of_block(
    fit: &Fit,
    rows: Range<usize>,
    weights: Option<&[f64]>,
) -> (DMatrix<f64>, DVector<f64>) {
    let count = fit.jacobian.len();
    let weighted = |values: &[f64]| match weights {
        Some(weights) => values.iter().zip(weights).map(|(v, w)| v * w).collect(),
        None => values.to_vec(),
    };
    let residuals: Vec<f64> = weighted(&fit.residuals[rows.clone()]);
    let mut hessian = DMatrix::zeros(count, count);
    let mut gradient = DVector::zeros(count);
    for (a, column) in fit.jacobian.iter().enumerate() {
        let column = &column[rows.clone()];
        gradient[a] = dot(column, &residuals);
        let column: Vec<f64> = weighted(column);
        for (b, other) in fit.jacobian.iter().enumerate().take(a + 1) {
            hessian[(a, b)] = dot(&column, &other[rows.clone()]);
            hessian[(b, a)] = hessian[(a, b)];
        }
    }
    (hessian, gradient)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(z: [f64; 2], residuals: [f64; 3], jacobian: &[[f64; 3]]) -> Fit {
        Fit {
            z: z.to_vec(),
            cost: square(&residuals),
            residuals: residuals.to_vec(),
            jacobian: jacobian.iter().map(|column| column.to_vec()).collect(),
        }
    }

    #[test]
    fn a_step_corrects_the_jacobian_along_itself_and_nowhere_else() {
        let columns = [[1.0, 0.0, 2.0], [0.5, -1.0, 0.0]];
        let from = fit([0.0, 1.0], [4.0, 5.0, 6.0], &columns);
        let to = fit([2.0, 2.0], [5.0, 3.0, 6.5], &[]);
        let slope = |fit: &Fit, [a, b]: [f64; 2]| -> Vec<f64> {
            let rows = fit.jacobian[0].iter().zip(&fit.jacobian[1]);
            rows.map(|(first, second)| a * first + b * second).collect()
        };
        let across = slope(&from, [-1.0, 2.0]);
        let moved = from.moved_to(to);
        for (found, expected) in slope(&moved, [2.0, 1.0]).iter().zip([1.0, -2.0, 0.5]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        for (found, expected) in slope(&moved, [-1.0, 2.0]).iter().zip(across) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// Rows are summed in blocks, the last of which is shorter.
    #[test]
    fn blocks_of_rows_sum_up_to_the_products_of_whole_columns() {
        let rows = 2 * BLOCK + 3;
        let column = |rate: f64| (0..rows).map(|n| (rate * n as f64).sin()).collect();
        let (a, b, residuals): (Vec<f64>, Vec<f64>, Vec<f64>) =
            (column(0.1), column(0.7), column(1.3));
        let fit = Fit {
            z: vec![0.0; 2],
            cost: square(&residuals),
            residuals: residuals.clone(),
            jacobian: vec![a.clone(), b.clone()],
        };
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let sums = (0..rows.div_ceil(BLOCK)).map(|block| {
            let block = block * BLOCK..((block + 1) * BLOCK).min(rows);
            normal_of_block(&fit, block, None)
        });
        let (hessian, gradient) = sums
            .reduce(|(h, g), (other_h, other_g)| (h + other_h, g + other_g))
            .unwrap();
        for (found, expected) in [
            (hessian[(0, 0)], sum(&a, &a)),
            (hessian[(1, 0)], sum(&a, &b)),
            (hessian[(0, 1)], sum(&a, &b)),
            (gradient[1], sum(&b, &residuals)),
        ] {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        let half = vec![0.5; BLOCK];
        let (weighted, _) = normal_of_block(&fit, 0..BLOCK, Some(&half));
        let (plain, _) = normal_of_block(&fit, 0..BLOCK, None);
        assert!((weighted[(1, 0)] - 0.5 * plain[(1, 0)]).abs() < 1e-12);
    }

    #[test]
    fn a_step_as_short_as_the_solvers_error_shows_nothing() {
        let columns = [[1.0, 0.0, 2.0], [0.5, -1.0, 0.0]];
        let from = fit([0.0, 1.0], [4.0, 5.0, 6.0], &columns);
        let to = fit([0.05, 1.05], [4.1, 4.9, 6.2], &[]);
        assert_eq!(from.clone().moved_to(to).jacobian, from.jacobian);
    }

    /// Defect seen: a log that began filled left such a point, and the step from it panicked.
    #[test]
    fn a_fit_that_begins_outside_of_its_bounds_steps_towards_them() {
        let plant = plant_sim::PlantParameters::nominal();
        let log = crate::bench::Bench::default().measure();
        let evidence = crate::diagnosis::fit::gather::gather(&plant, [&log]).unwrap();
        let unknowns = Unknowns::new(&plant, &[], &evidence.logs);
        let fitter = Fitter::new(&evidence, &unknowns);
        let mut outside = fitter.at(unknowns.start()).unwrap();
        outside.z.fill(4.0);
        outside.jacobian = vec![vec![0.0; outside.residuals.len()]; unknowns.len()];
        let (z, _) = fitter.step(&outside, 0.0);
        assert!(z.iter().all(|&z| z <= 4.0 - 1.4), "{z:?}");
    }
}
