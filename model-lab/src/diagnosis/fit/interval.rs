//! Confidence intervals of fitted parameters.

use nalgebra::DMatrix;

use super::Fitter;
use super::trial::Trial;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::unknowns::Unknown;

/// Number of samples of a block within which errors may be correlated.
const BLOCK: usize = 100;
/// Least curvature of every parameter: a standard deviation of a thousand typical sizes.
const UNSEEN: f64 = 1e-6;
/// Half width of a 95 % interval (standard deviations).
pub(crate) const NORMAL_95: f64 = 1.96;
/// Standard deviation, as a share of its value, of a parameter between two correct programs of one plant: the simulator and the reference
/// plant of the blind benchmark (docs/blind-benchmark.md, "Intervals").
const BETWEEN_PROGRAMS: f64 = 0.025;

/// Returns the half widths of the 95 % intervals in the coordinates of the fit; infinite where nothing is known.
///
/// The larger of two estimates: that of the curvature with the size and autocorrelation of the error, and the sandwich of the gradient's
/// scatter over blocks (P. J. Huber 1967), which also covers errors that are neither equal nor independent.
pub(crate) fn half_widths(evidence: &Evidence, trial: &Trial) -> Vec<f64> {
    let count = trial.unknowns.len();
    let Some(inverse) = inverse_curvature(evidence, trial) else {
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

/// Returns the half widths if only the noise were left: the accuracy that the logs allow once other effects explain the rest.
pub(crate) fn half_widths_of_noise(evidence: &Evidence, trial: &Trial) -> Vec<f64> {
    let count = trial.unknowns.len();
    let Some(inverse) = inverse_curvature(evidence, trial) else {
        return vec![f64::INFINITY; count];
    };
    (0..count)
        .map(|n| NORMAL_95 * inverse[(n, n)].max(0.0).sqrt())
        .collect()
}

/// Returns the covariance of the coordinates if only the noise is left.
pub(crate) fn covariance(evidence: &Evidence, trial: &Trial) -> Option<DMatrix<f64>> {
    inverse_curvature(evidence, trial)
}

fn inverse_curvature(evidence: &Evidence, trial: &Trial) -> Option<DMatrix<f64>> {
    let fitter = Fitter::new(evidence, &trial.unknowns);
    let (mut hessian, _) = fitter.normal(&trial.fit);
    for n in 0..trial.unknowns.len() {
        // A direction that the logs do not show at all must not hide those that they show.
        hessian[(n, n)] += UNSEEN;
    }
    hessian.try_inverse()
}

/// Returns the 95 % interval of `value`. `low` and `high` are its ends due to noise; they are widened by the difference between correct
/// programs, which is independent of the noise (JCGM 100:2008, 5.1.2).
pub(crate) fn with_model_error(value: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    let model_error = NORMAL_95 * BETWEEN_PROGRAMS * value.abs();
    [
        value - (value - low).hypot(model_error),
        value + (high - value).hypot(model_error),
    ]
}

/// Returns the half width of the interval of `unknown` (coordinate), from the one due to noise: widened by the difference between correct
/// programs.
pub(crate) fn between_programs(unknown: &Unknown, of_noise: f64) -> f64 {
    of_noise.hypot(NORMAL_95 * unknown.between_programs())
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

#[cfg(test)]
mod tests {
    use super::with_model_error;

    #[test]
    fn noise_and_model_error_add_as_independent_ones() {
        let [low, high] = with_model_error(-100.0, [-103.0, -88.0]);
        assert!((low - (-100.0 - 3_f64.hypot(4.9))).abs() < 1e-9, "{low}");
        assert!((high - (-100.0 + 12_f64.hypot(4.9))).abs() < 1e-9, "{high}");
    }

    #[test]
    fn a_value_of_nothing_has_the_interval_of_the_noise() {
        assert_eq!(with_model_error(0.0, [-0.5, 0.25]), [-0.5, 0.25]);
    }

    #[test]
    fn what_the_logs_leave_open_stays_open() {
        let ends = with_model_error(2.0, [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(ends, [f64::NEG_INFINITY, f64::INFINITY]);
    }
}
