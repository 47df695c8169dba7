//! Time offset of a measurement behind the model.
//!
//! The comparison uses changes over a short span, not values, because a model that drifts away still changes at the right moment. Their
//! correlation does not depend on the size of the changes, so a wrong discharge coefficient is not mistaken for a delay. The model is known
//! on a fine grid, so it can be shifted by less than a sample.

use crate::result::TimeOffset;

/// Span over which changes are taken (s), at least one sample.
const SPAN_S: f64 = 0.05;
/// Range of lags searched on either side (samples), at least [`REACH_MIN_S`].
const REACH_SAMPLES: f64 = 3.0;
const REACH_MIN_S: f64 = 5e-3;
/// Distance of the tried shifts (s), before a parabola refines the best one.
const SHIFT_S: f64 = 1e-3;
/// Number of shifts tried on either side, at most; slow logs are searched in wider steps.
const SHIFTS_MAX: usize = 300;
/// Smallest lag that is reported (s).
const WORTH_MENTIONING_S: f64 = 0.5e-3;
/// Smallest share of the mismatch that a genuine lag removes; a shift that removes less only compensates another error.
const CLEAR: f64 = 0.2;
/// Smallest correlation of the changes at which a signal determines a lag.
const LEAST_CORRELATION: f64 = 0.5;

/// Model between the samples of the log.
pub(crate) enum FineTrace<'a> {
    /// Instantaneous values.
    Instants {
        /// Instants (s).
        times_s: &'a [f64],
        /// Values at the instants.
        values: &'a [f64],
    },
    /// Integral of a signal that is logged as the mean over the interval that ends at the sample.
    Integral {
        /// Instants (s).
        times_s: &'a [f64],
        /// Integral from the first instant to each.
        integral: Vec<f64>,
    },
}

impl<'a> FineTrace<'a> {
    pub(crate) fn of_instants(times_s: &'a [f64], values: &'a [f64]) -> Self {
        Self::Instants { times_s, values }
    }

    /// Returns the integral of `means`, which refer to the grid intervals that end at `times_s`.
    pub(crate) fn of_means(times_s: &'a [f64], means: &[f64]) -> Self {
        let mut sum = 0.0;
        let integral = (0..times_s.len())
            .map(|n| {
                sum += if n == 0 {
                    0.0
                } else {
                    means[n] * (times_s[n] - times_s[n - 1])
                };
                sum
            })
            .collect();
        Self::Integral { times_s, integral }
    }

    /// Returns the values that a log would contain at `sample_s`, delayed by `lag_s`.
    fn sample(&self, sample_s: &[f64], lag_s: f64) -> Vec<f64> {
        match self {
            Self::Instants { times_s, values } => interpolate(times_s, values, sample_s, lag_s),
            Self::Integral { times_s, integral } => {
                let integral = interpolate(times_s, integral, sample_s, lag_s);
                let mean =
                    |n: usize| (integral[n] - integral[n - 1]) / (sample_s[n] - sample_s[n - 1]);
                (0..sample_s.len())
                    .map(|n| if n == 0 { f64::NAN } else { mean(n) })
                    .collect()
            }
        }
    }
}

/// Interpolates linearly between the grid points; constant beyond the ends.
fn interpolate(times_s: &[f64], values: &[f64], sample_s: &[f64], lag_s: f64) -> Vec<f64> {
    let mut right = 0;
    let at = |&sample_s: &f64| {
        let time_s = sample_s - lag_s;
        while right < times_s.len() && times_s[right] < time_s {
            right += 1;
        }
        if right == 0 || right == times_s.len() {
            return values[right.min(values.len() - 1)];
        }
        let share = (time_s - times_s[right - 1]) / (times_s[right] - times_s[right - 1]);
        values[right - 1] + share * (values[right] - values[right - 1])
    };
    sample_s.iter().map(at).collect()
}

/// Returns the lag of `measured` at `times_s` behind `model`; none where the changes of the measurement do not correlate with those of the
/// model.
pub(crate) fn time_offset(
    times_s: &[f64],
    measured: &[f64],
    model: &FineTrace,
    name: &str,
) -> Option<TimeOffset> {
    let interval_s = (times_s.last()? - times_s[0]) / (times_s.len() - 1).max(1) as f64;
    if interval_s <= 0.0 {
        return None;
    }
    let span = (SPAN_S / interval_s).round().max(1.0) as usize;
    let reach_s = (REACH_SAMPLES * interval_s).max(REACH_MIN_S);
    let steps = ((reach_s / SHIFT_S.min(reach_s / 5.0)).round() as usize).min(SHIFTS_MAX);
    let shift_s = reach_s / steps as f64;
    let correlation =
        |lag_s: f64| change_correlation(measured, &model.sample(times_s, lag_s), span);
    let unshifted = correlation(0.0)?;
    let lag_of = |index: usize| (index as f64 - steps as f64) * shift_s;
    let correlations: Option<Vec<f64>> = (0..=2 * steps)
        .map(|index| correlation(lag_of(index)))
        .collect();
    let correlations = correlations?;
    let best =
        (0..correlations.len()).max_by(|&a, &b| correlations[a].total_cmp(&correlations[b]))?;
    if correlations[best] < LEAST_CORRELATION {
        return None;
    }
    let at_search_limit = best == 0 || best == 2 * steps;
    let refinement = if at_search_limit {
        0.0
    } else {
        vertex(&correlations[best - 1..=best + 1])
    };
    let lag_s = lag_of(best) + refinement * shift_s;
    let shifted = correlation(lag_s)?;
    let mismatch_explained =
        1.0 - (1.0 - shifted.powi(2)) / (1.0 - unshifted.powi(2)).max(f64::MIN_POSITIVE);
    Some(TimeOffset {
        lag_ms: lag_s * 1e3,
        correlation_unshifted: unshifted,
        correlation_shifted: shifted,
        mismatch_explained,
        at_search_limit,
        statement: statement(name, lag_s, mismatch_explained, at_search_limit),
    })
}

fn statement(name: &str, lag_s: f64, mismatch_explained: f64, at_search_limit: bool) -> String {
    if lag_s.abs() < WORTH_MENTIONING_S {
        return format!("measured {name} is in time with the model");
    }
    if mismatch_explained < CLEAR {
        return format!("measured {name} has no clear lag: other errors are larger");
    }
    let verb = if lag_s > 0.0 { "lags" } else { "leads" };
    let least = if at_search_limit { "at least " } else { "" };
    format!(
        "measured {name} {verb} the model by {least}{:.1} ms, which accounts for {:.0} % of the mismatch of its changes",
        lag_s.abs() * 1e3,
        100.0 * mismatch_explained
    )
}

/// Returns the correlation of the changes over `span` samples; none where either does not change.
fn change_correlation(a: &[f64], b: &[f64], span: usize) -> Option<f64> {
    let changes = (span..a.len()).map(|n| (a[n] - a[n - span], b[n] - b[n - span]));
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in changes.filter(|(a, b)| a.is_finite() && b.is_finite()) {
        aa += a * a;
        ab += a * b;
        bb += b * b;
    }
    (aa > 0.0 && bb > 0.0).then(|| ab / (aa * bb).sqrt())
}

/// Returns the position of the maximum of the parabola through three equally spaced points, in steps from the middle.
fn vertex(points: &[f64]) -> f64 {
    let bend = points[0] - 2.0 * points[1] + points[2];
    if bend < 0.0 {
        (0.5 * (points[0] - points[2]) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    /// Returns the lag found for a trace with ramps, delayed by `lag_s`, with noise and a gain error.
    fn found_lag_ms(lag_s: f64, gain: f64, drift: f64) -> f64 {
        let trace = |t: f64| (2.0 * t).sin() + 0.3 * (17.0 * t).sin();
        let mut noise = Noise::new(7);
        let fine: Vec<f64> = (0..20_000).map(|n| f64::from(n) * 1e-3).collect();
        let values: Vec<f64> = fine.iter().map(|&t| trace(t)).collect();
        let times_s: Vec<f64> = (0..2000).map(|n| f64::from(n) * 0.01).collect();
        let measured: Vec<f64> = times_s
            .iter()
            .map(|t| gain * trace(t - lag_s) + drift * t + 4e-3 * noise.normal())
            .collect();
        time_offset(
            &times_s,
            &measured,
            &FineTrace::of_instants(&fine, &values),
            "p_ch",
        )
        .unwrap()
        .lag_ms
    }

    #[test]
    fn a_shift_is_found_within_a_tenth_of_a_millisecond_whatever_gain_and_drift() {
        for lag_s in [-7.3e-3, 0.0, 0.4e-3, 3e-3, 12e-3] {
            for (gain, drift) in [(1.0, 0.0), (0.8, 0.0), (1.0, 0.02)] {
                let found = found_lag_ms(lag_s, gain, drift);
                assert!(
                    (found - lag_s * 1e3).abs() < 0.1,
                    "{lag_s} s, gain {gain}, drift {drift}: {found} ms"
                );
            }
        }
    }

    #[test]
    fn a_lag_beyond_the_search_is_said_to_be_at_least_that() {
        let times_s: Vec<f64> = (0..2000).map(|n| f64::from(n) * 0.01).collect();
        let ramp = |t: f64| (t * 0.5).fract();
        let model: Vec<f64> = times_s.iter().map(|&t| ramp(t)).collect();
        let measured: Vec<f64> = times_s.iter().map(|&t| ramp(t - 0.05)).collect();
        let found = time_offset(
            &times_s,
            &measured,
            &FineTrace::of_instants(&times_s, &model),
            "p_ch",
        );
        assert!(found.is_none_or(|found| found.at_search_limit));
    }

    #[test]
    fn a_lag_that_explains_little_is_not_claimed() {
        assert!(statement("p_ch", 3e-3, 0.05, false).contains("no clear lag"));
        assert!(statement("p_ch", 3e-3, 0.5, false).contains("lags the model by 3.0 ms"));
        assert!(statement("p_ch", -3e-3, 0.5, true).contains("leads the model by at least 3.0 ms"));
        assert!(statement("p_ch", 1e-4, 0.9, false).contains("in time"));
    }

    #[test]
    fn a_signal_that_does_not_follow_the_model_has_no_lag() {
        let times_s: Vec<f64> = (0..500).map(|n| f64::from(n) * 0.01).collect();
        let model: Vec<f64> = times_s.iter().map(|t| t.sin()).collect();
        let trace = FineTrace::of_instants(&times_s, &model);
        assert_eq!(time_offset(&times_s, &[1.0; 500], &trace, "p_ch"), None);
        let mut noise = Noise::new(1);
        let noise: Vec<f64> = (0..500).map(|_| noise.normal()).collect();
        assert_eq!(time_offset(&times_s, &noise, &trace, "p_ch"), None);
    }

    #[test]
    fn means_are_shifted_as_integrals() {
        let times_s = [0.0, 0.5, 1.0, 1.5, 2.0];
        let trace = FineTrace::of_means(&times_s, &[f64::NAN, 1.0, 3.0, 5.0, 7.0]);
        let sampled = trace.sample(&[0.0, 1.0, 2.0], 0.0);
        assert!(sampled[0].is_nan());
        assert_eq!(sampled[1..], [2.0, 6.0]);
        let late = trace.sample(&[0.0, 1.0, 2.0], 0.5);
        assert_eq!(late[2], 4.0);
    }
}
