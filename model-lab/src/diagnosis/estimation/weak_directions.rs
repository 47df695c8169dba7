//! Derivatives in the directions that the logs leave undetermined.
//!
//! Some combinations of parameters change nothing: all flows and the volume in proportion, or without currents the resistance, the
//! inductances and the force constant. Each difference quotient of a single parameter contains the solver's error, and their combination
//! shows a false curvature. Along the combination itself the step can be as long as the parameters are uncertain, so its quotient is
//! accurate.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::evidence::log::Residuals;
use crate::diagnosis::fit::{Fit, Fitter};

/// Standard deviation, in coordinates, above which a direction is weak: about the step of the difference quotients of single parameters.
const WEAK_SD: f64 = 0.004;
/// Step along a weak direction, over its standard deviation, ...
const STEP_SD: f64 = 0.7;
/// ... and in the coordinate that moves most, least and largest value.
const STEP: (f64, f64) = (0.02, 0.25);
/// Number of passes: a direction measured once may still be mixed with stronger ones, which later passes separate.
const PASSES: usize = 3;

/// Recomputes the Jacobian of `fit` along its weak directions; unchanged where these cannot be simulated, or where nothing is fitted.
pub(in crate::diagnosis) fn measure_weak_directions(fitter: &Fitter, fit: &mut Fit) {
    if fit.jacobian.is_empty() {
        return;
    }
    for _ in 0..PASSES {
        let (curvature, _) = fitter.normal(fit);
        let eigen = curvature.symmetric_eigen();
        let directions: Vec<DVector<f64>> = eigen
            .eigenvectors
            .column_iter()
            .map(|direction| direction.into_owned())
            .collect();
        let count = fit.jacobian.len();
        let mut along: Vec<Residuals> = Vec::with_capacity(count);
        for (direction, &curvature) in directions.iter().zip(eigen.eigenvalues.iter()) {
            let sd = curvature.max(f64::MIN_POSITIVE).sqrt().recip();
            let measured = (sd > WEAK_SD)
                .then(|| slope_along(fitter, &fit.z, direction, sd))
                .flatten();
            along.push(measured.unwrap_or_else(|| combined(&fit.jacobian, direction)));
        }
        let back = DMatrix::from_columns(&directions).transpose();
        for n in 0..count {
            let weights = back.column(n).into_owned();
            fit.jacobian[n] = combined(&along, &weights);
        }
    }
}

/// Returns the fit after a step with the Jacobian of `sharp`: along undetermined directions towards the plant file. None where that
/// increases the cost.
pub(super) fn settled(fitter: &Fitter, sharp: &Fit) -> Option<Fit> {
    let (z, _) = fitter.step(sharp, 0.0);
    let there = fitter.at(z)?;
    (there.cost < sharp.cost).then(|| Fit {
        jacobian: sharp.jacobian.clone(),
        ..there
    })
}

/// Returns d residual / d step along `direction` from `z`, by a two-sided difference.
fn slope_along(fitter: &Fitter, z: &[f64], direction: &DVector<f64>, sd: f64) -> Option<Residuals> {
    let (least, most) = STEP;
    let step = (STEP_SD * sd * direction.amax()).clamp(least, most) / direction.amax();
    let moved = |step: f64| {
        let moved = z.iter().zip(direction.iter()).map(|(z, d)| z + step * d);
        fitter.at(moved.collect())
    };
    let (above, below) = rayon::join(|| moved(step), || moved(-step));
    let (above, below) = (above?.residuals, below?.residuals);
    let pairs = above.iter().zip(&below);
    Some(
        pairs
            .map(|(above, below)| (above - below) / (2.0 * step))
            .collect(),
    )
}

/// Returns the sum of `columns`, each times its weight.
fn combined(columns: &[Residuals], weights: &DVector<f64>) -> Residuals {
    let mut sum = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (column, weight) in columns.iter().zip(weights.iter()) {
        for (sum, value) in sum.iter_mut().zip(column) {
            *sum += weight * value;
        }
    }
    sum
}
