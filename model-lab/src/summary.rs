use crate::metrics::{fit_pct, mean, rms, worst};
use crate::result::{ErrorSummary, Horizon};
use crate::whiteness::{Input, Whiteness};

/// Returns all measures of one residual. `floors` are the noise floor and the rms of a perfect model, 0 where unknown.
pub(crate) fn summary(
    residual: &[f64],
    measured: &[f64],
    times_s: &[f64],
    (floor, expected): (f64, f64),
    inputs: &[Input],
    horizon: Horizon,
) -> ErrorSummary {
    let rms = rms(residual).unwrap_or_default();
    let (worst_index, worst) = worst(residual).unwrap_or_default();
    let whiteness = Whiteness::of(residual);
    let in_noise = |error: f64| (floor > 0.0).then(|| error / floor);
    ErrorSummary {
        rms,
        expected_rms: (expected > 0.0).then_some(expected),
        rms_in_noise: in_noise(rms),
        worst,
        worst_in_noise: in_noise(worst.abs()),
        worst_time_s: times_s[worst_index],
        bias: mean(residual).unwrap_or_default(),
        fit_pct: fit_pct(measured, residual),
        autocorrelation_time_samples: whiteness.autocorrelation_time_samples(),
        whiteness: match horizon {
            Horizon::FreeRun => whiteness.ljung_box(),
            Horizon::OneStepAhead => None,
        },
        input_correlation: whiteness.input_correlations(inputs),
    }
}
