//! Measures of an error. Missing samples are NaN and are left out.

/// Returns the samples that are not missing.
pub(crate) fn present(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    values.iter().copied().filter(|value| !value.is_nan())
}

/// Returns the values of these rows.
pub(crate) fn picked(values: &[f64], rows: &[usize]) -> Vec<f64> {
    rows.iter().map(|&row| values[row]).collect()
}

/// Returns the mean; none without samples.
pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    let (count, sum) = present(values).fold((0_usize, 0.0), |(n, sum), value| (n + 1, sum + value));
    (count > 0).then(|| sum / count as f64)
}

/// Returns the root mean square; none without samples.
pub(crate) fn rms(values: &[f64]) -> Option<f64> {
    let (count, sum) = present(values).fold((0_usize, 0.0), |(n, sum), value| {
        (n + 1, sum + value * value)
    });
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// Returns index and value of the error of largest magnitude, the first of equals; none without samples.
pub(crate) fn worst(residual: &[f64]) -> Option<(usize, f64)> {
    residual
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, error)| !error.is_nan())
        .fold(None, |worst, candidate| match worst {
            Some((_, error)) if f64::abs(error) >= candidate.1.abs() => worst,
            _ => Some(candidate),
        })
}

/// Returns 100 (1 - |residual| / |measured - mean|) (%); none where the measurement is constant.
pub(crate) fn fit_pct(measured: &[f64], residual: &[f64]) -> Option<f64> {
    let mean = mean(measured)?;
    let scatter: f64 = present(measured).map(|value| (value - mean).powi(2)).sum();
    let error: f64 = present(residual).map(|error| error * error).sum();
    (scatter > 0.0).then(|| 100.0 * (1.0 - (error / scatter).sqrt()))
}

/// Returns measured minus modelled, NaN where the measurement is missing.
pub(crate) fn residual(measured: &[f64], modelled: &[f64]) -> Vec<f64> {
    measured
        .iter()
        .zip(modelled)
        .map(|(measured, modelled)| measured - modelled)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_samples_count_nowhere() {
        let values = [3.0, f64::NAN, -4.0];
        assert_eq!(mean(&values), Some(-0.5));
        assert_eq!(rms(&values), Some(12.5_f64.sqrt()));
        assert_eq!(worst(&values), Some((2, -4.0)));
        assert_eq!(
            (mean(&[f64::NAN]), rms(&[]), worst(&[f64::NAN])),
            (None, None, None)
        );
    }

    #[test]
    fn residual_is_measured_minus_modelled() {
        let residual = residual(&[2.0, f64::NAN], &[1.5, 1.0]);
        assert_eq!(residual[0], 0.5);
        assert!(residual[1].is_nan());
    }

    #[test]
    fn the_first_of_equal_errors_is_the_worst() {
        assert_eq!(worst(&[1.0, -2.0, 2.0]), Some((1, -2.0)));
    }

    #[test]
    fn fit_is_full_for_a_perfect_model_zero_for_the_mean_and_negative_beyond() {
        let measured = [1.0, 2.0, 3.0];
        assert_eq!(fit_pct(&measured, &[0.0; 3]), Some(100.0));
        assert_eq!(fit_pct(&measured, &[-1.0, 0.0, 1.0]), Some(0.0));
        assert_eq!(fit_pct(&measured, &[2.0, 0.0, 2.0]), Some(-100.0));
        assert_eq!(fit_pct(&[1.0; 3], &[0.1; 3]), None);
    }
}
