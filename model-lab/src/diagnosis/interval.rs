//! How well a fit knows its parameters.

use nalgebra::DMatrix;

use super::evidence::Evidence;
use super::fit::Fitter;
use super::trial::Trial;

/// Samples of a block within which errors may hang together.
const BLOCK: usize = 100;
/// Curvature that everything has: a standard deviation of a thousand typical sizes.
const UNSEEN: f64 = 1e-6;
/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.96;

/// Half widths of the 95 % intervals in the coordinates of the fit; infinite where nothing is known.
///
/// The larger of two estimates: that of the curvature with the error's own size and memory, and the sandwich of the
/// gradient's scatter over blocks (P. J. Huber 1967), which sees errors that are neither equal nor independent.
pub(crate) fn half_widths(evidence: &Evidence, trial: &Trial) -> Vec<f64> {
    let fitter = Fitter::new(evidence, &trial.unknowns);
    let (mut hessian, _) = fitter.normal(&trial.fit);
    let count = trial.unknowns.len();
    for n in 0..count {
        // What the logs do not show at all must not hide what they show of the rest.
        hessian[(n, n)] += UNSEEN;
    }
    let Some(inverse) = hessian.try_inverse() else {
        return vec![f64::INFINITY; count];
    };
    let size = 1.0 + trial.fitted.total_excess();
    let scatter = scatter_of_gradient(evidence, trial);
    let sandwich = &inverse * scatter * &inverse;
    (0..count)
        .map(|n| {
            let plain = inverse[(n, n)] * size * trial.correlation_samples;
            NORMAL_95 * plain.max(sandwich[(n, n)]).max(0.0).sqrt()
        })
        .collect()
}

fn scatter_of_gradient(evidence: &Evidence, trial: &Trial) -> DMatrix<f64> {
    let columns = &trial.fit.jacobian;
    let count = columns.len();
    let mut scatter = DMatrix::zeros(count, count);
    for (n, unknown) in trial.unknowns.list().iter().enumerate() {
        scatter[(n, n)] += unknown.prior_sd().powi(-2);
    }
    for (_, _, range) in evidence.channels() {
        let mut begin = range.start;
        while begin < range.end {
            let block = begin..(begin + BLOCK).min(range.end);
            let gradient: Vec<f64> = columns
                .iter()
                .map(|column| {
                    super::vector::dot(&column[block.clone()], &trial.fit.residuals[block.clone()])
                })
                .collect();
            for a in 0..count {
                for b in 0..count {
                    scatter[(a, b)] += gradient[a] * gradient[b];
                }
            }
            begin = block.end;
        }
    }
    scatter
}
