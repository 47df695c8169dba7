use crate::metrics::{fit_pct, mean, rms, worst};
use crate::result::{ErrorSummary, Horizon};
use crate::whiteness::{Input, Whiteness};

/// Errors that are unavoidable, in the unit of the signal; 0 where unknown.
#[derive(Clone, Copy)]
pub(crate) struct Floors {
    /// Standard deviation of the measurement noise.
    pub(crate) noise: f64,
    /// Rms error of a perfect model.
    pub(crate) expected_rms: f64,
}

/// Returns all measures of one residual.
pub(crate) fn summary(
    residual: &[f64],
    measured: &[f64],
    times_s: &[f64],
    floors: Floors,
    inputs: &[Input],
    horizon: Horizon,
) -> ErrorSummary {
    let rms = rms(residual).unwrap_or_default();
    let (worst_index, worst) = worst(residual).unwrap_or_default();
    let whiteness = Whiteness::of(residual);
    let in_noise = |error: f64| (floors.noise > 0.0).then(|| error / floors.noise);
    ErrorSummary {
        rms,
        expected_rms: (floors.expected_rms > 0.0).then_some(floors.expected_rms),
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
