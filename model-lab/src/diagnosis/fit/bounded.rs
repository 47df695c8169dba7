//! Least value of a convex quadratic function within bounds: a primal active-set method.
//!
//! J. Nocedal, S. J. Wright, Numerical Optimization, Springer (2006), algorithm 16.3.

use nalgebra::{DMatrix, DVector};

/// Passes for each coordinate, at most; each fixes or frees a coordinate.
const PASSES: usize = 10;
/// Share of the slope of a coordinate, over its scale, below which it counts as zero.
const FLAT: f64 = 1e-9;

/// Returns the `x` within `bounds` with the least `½ xᵀ H x + gᵀ x`, for a positive definite `hessian` H and the `gradient` g. A bound that
/// excludes 0 is reached first.
pub(super) fn least(
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
    bounds: &[(f64, f64)],
) -> Vec<f64> {
    let mut x = DVector::from_iterator(
        bounds.len(),
        bounds.iter().map(|&(low, high)| 0.0_f64.clamp(low, high)),
    );
    let mut free: Vec<usize> = (0..bounds.len())
        .filter(|&n| bounds[n].0 < bounds[n].1)
        .collect();
    for _ in 0..PASSES * bounds.len() {
        let slope = gradient + hessian * &x;
        let Some(direction) = newton(hessian, &slope, &free) else {
            break;
        };
        // The first bound on the way.
        let blocks = free.iter().enumerate().filter_map(|(place, &n)| {
            let (low, high) = bounds[n];
            let towards = if direction[place] < 0.0 { low } else { high };
            let share = (towards - x[n]) / direction[place];
            (share < 1.0).then_some((place, towards, share.max(0.0)))
        });
        let first = blocks.min_by(|a, b| a.2.total_cmp(&b.2));
        let share = first.map_or(1.0, |(.., share)| share);
        for (&n, direction) in free.iter().zip(direction.iter()) {
            x[n] += share * direction;
        }
        if let Some((place, bound, _)) = first {
            x[free.remove(place)] = bound;
            continue;
        }
        let slope = gradient + hessian * &x;
        let inwards = (0..bounds.len()).filter(|n| !free.contains(n));
        let inwards = inwards.filter(|&n| {
            let (low, high) = bounds[n];
            low < high
                && if x[n] <= low {
                    slope[n] < 0.0
                } else {
                    slope[n] > 0.0
                }
        });
        let gain = |n: usize| slope[n].abs() / hessian[(n, n)].sqrt();
        let steepest = inwards.max_by(|&a, &b| gain(a).total_cmp(&gain(b)));
        let scale = (0..bounds.len()).map(|n| gradient[n].abs() / hessian[(n, n)].sqrt());
        match steepest.filter(|&n| gain(n) > FLAT * scale.fold(0.0, f64::max)) {
            Some(n) => free.push(n),
            None => break,
        }
    }
    x.iter().copied().collect()
}

/// Returns the change of the `free` coordinates to the least value without bounds; none if the matrix is not positive definite.
fn newton(hessian: &DMatrix<f64>, slope: &DVector<f64>, free: &[usize]) -> Option<DVector<f64>> {
    let matrix = DMatrix::from_fn(free.len(), free.len(), |a, b| hessian[(free[a], free[b])]);
    let right = DVector::from_fn(free.len(), |a, _| -slope[free[a]]);
    Some(matrix.cholesky()?.solve(&right))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const COUNT: usize = 4;

    /// Returns a positive definite matrix whose eigenvalues differ by up to a million.
    fn matrix(entries: &[f64]) -> DMatrix<f64> {
        let factor = DMatrix::from_row_slice(COUNT, COUNT, entries);
        factor.transpose() * &factor + DMatrix::identity(COUNT, COUNT) * 1e-4
    }

    fn value(hessian: &DMatrix<f64>, gradient: &DVector<f64>, x: &DVector<f64>) -> f64 {
        0.5 * x.dot(&(hessian * x)) + gradient.dot(x)
    }

    /// Returns the least value over all choices of the coordinates that are at one of their bounds.
    fn least_of_all_choices(
        hessian: &DMatrix<f64>,
        gradient: &DVector<f64>,
        bounds: &[(f64, f64)],
    ) -> f64 {
        let choices = (0..3_usize.pow(COUNT as u32)).filter_map(|choice| {
            let place = |n: usize| choice / 3_usize.pow(n as u32) % 3;
            let at_bound = |n: usize| [0.0, bounds[n].0, bounds[n].1][place(n)];
            let mut x = DVector::from_fn(COUNT, |n, _| at_bound(n));
            let free: Vec<usize> = (0..COUNT).filter(|&n| place(n) == 0).collect();
            let moved = newton(hessian, &(gradient + hessian * &x), &free)?;
            (free.iter().zip(moved.iter())).for_each(|(&n, moved)| x[n] += moved);
            let is_within = (0..COUNT).all(|n| (bounds[n].0..=bounds[n].1).contains(&x[n]));
            is_within.then(|| value(hessian, gradient, &x))
        });
        choices.fold(f64::INFINITY, f64::min)
    }

    proptest! {
        /// Reference: each coordinate at its lower bound, at its upper one, or free.
        #[test]
        fn no_choice_of_bounds_leaves_less(
            entries in proptest::collection::vec(-3.0..3.0, COUNT * COUNT),
            gradient in proptest::collection::vec(-5.0..5.0, COUNT),
            lows in proptest::collection::vec(-1.0..0.5, COUNT),
            widths in proptest::collection::vec(0.01..2.0, COUNT),
        ) {
            let (hessian, gradient) = (matrix(&entries), DVector::from_vec(gradient));
            let bounds: Vec<_> = (lows.iter().zip(&widths)).map(|(low, width)| (*low, low + width)).collect();
            let found = least(&hessian, &gradient, &bounds);
            for (x, (low, high)) in found.iter().zip(&bounds) {
                prop_assert!((low - 1e-12..=high + 1e-12).contains(x), "{found:?}");
            }
            let reached = value(&hessian, &gradient, &DVector::from_vec(found));
            let best = least_of_all_choices(&hessian, &gradient, &bounds);
            prop_assert!(reached <= best + 1e-7 * (1.0 + best.abs()), "{reached} {best}");
        }
    }

    /// Defect seen: coordinates that would leave their bounds together were all fixed, and none was freed again. Fits with a dozen values at
    /// the ends of their ranges stopped at twice the error.
    #[test]
    fn a_coordinate_is_freed_once_another_one_is_fixed() {
        let hessian = DMatrix::from_row_slice(2, 2, &[1.0, 0.9, 0.9, 1.0]);
        let gradient = DVector::from_vec(vec![-1.9, -2.1]);
        // Without bounds at (0.05, 2.05); with the second one at 1, the first one goes to 1.
        let found = least(&hessian, &gradient, &[(-3.0, 3.0), (-3.0, 1.0)]);
        assert!(
            (found[0] - 1.0).abs() < 1e-9 && found[1] == 1.0,
            "{found:?}"
        );
        // Both would leave: (3.15, -0.95) is outside of both, and the least value is at a corner of the first one only.
        let gradient = DVector::from_vec(vec![-2.295, -1.885]);
        let found = least(&hessian, &gradient, &[(-0.5, 1.0), (-0.5, 3.0)]);
        assert!(
            (found[1] - 0.985).abs() < 1e-9 && found[0] == 1.0,
            "{found:?}"
        );
        let fixed = least(&hessian, &gradient, &[(0.0, 0.0), (-0.5, 3.0)]);
        assert!(
            fixed[0] == 0.0 && (fixed[1] - 1.885).abs() < 1e-9,
            "{fixed:?}"
        );
    }
}
