//! Histogram of values.

use serde::Serialize;

/// Number of bins: fewer show no shape, more are narrower than a pixel.
const BINS: std::ops::RangeInclusive<usize> = 8..=160;

/// Shares of samples by value.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Histogram {
    samples: usize,
    mean: f64,
    standard_deviation: f64,
    /// Left edge of the first bin.
    from: f64,
    bin_width: f64,
    /// Share of the samples in each bin, divided by its width (1/unit).
    density: Vec<f64>,
}

impl Histogram {
    /// Returns the histogram of the values that are not missing; `None` if all are missing.
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let present = || values.iter().copied().filter(|value| !value.is_nan());
        let samples = present().count();
        if samples == 0 {
            return None;
        }
        let count = samples as f64;
        let mean = present().sum::<f64>() / count;
        let variance = present().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        let standard_deviation = variance.sqrt();
        let low = present().fold(f64::INFINITY, f64::min);
        let high = present().fold(f64::NEG_INFINITY, f64::max);
        let (from, span) = around(low, high);
        let bins = bins(span, standard_deviation, count);
        let bin_width = span / bins as f64;
        let mut density = vec![0.0; bins];
        for value in present() {
            let bin = ((value - from) / bin_width) as usize;
            density[bin.min(bins - 1)] += 1.0 / (count * bin_width);
        }
        Some(Self {
            samples,
            mean,
            standard_deviation,
            from,
            bin_width,
            density,
        })
    }
}

/// Returns the range of the bins, wide enough to be divided even if all values are equal.
fn around(low: f64, high: f64) -> (f64, f64) {
    let least = 1e-9 * low.abs().max(high.abs()).max(1e-6);
    if high - low > least {
        (low, high - low)
    } else {
        (low - least, 2.0 * least)
    }
}

/// Returns the number of bins by Scott's rule (D. W. Scott, Biometrika 66, 1979).
fn bins(span: f64, standard_deviation: f64, count: f64) -> usize {
    let width = 3.49 * standard_deviation / count.cbrt();
    // Values without spread get the fewest bins.
    let wanted = if width > 0.0 { span / width } else { 0.0 };
    (wanted as usize).clamp(*BINS.start(), *BINS.end())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(histogram: &Histogram) -> f64 {
        histogram.density.iter().sum::<f64>() * histogram.bin_width
    }

    #[test]
    fn all_samples_that_are_there_are_in_the_bins() {
        let mut values: Vec<f64> = (0..10_000)
            .map(|index| ((index * 7919) % 10_007) as f64 * 1e-3)
            .collect();
        values[5] = f64::NAN;
        let histogram = Histogram::of(&values).unwrap();
        assert_eq!(histogram.samples, 9_999);
        assert!((area(&histogram) - 1.0).abs() < 1e-9);
        assert!((histogram.mean - 5.0).abs() < 0.01);
        // Uniform over about 10 units.
        assert!((histogram.standard_deviation - 10.0 / 12.0_f64.sqrt()).abs() < 0.01);
        assert!(
            histogram
                .density
                .iter()
                .all(|density| (density - 0.1).abs() < 0.01)
        );
    }

    #[test]
    fn what_never_changes_and_what_jumps_once_still_have_bins() {
        for values in [vec![0.0; 50], vec![1e9; 50], vec![2.5]] {
            let histogram = Histogram::of(&values).unwrap();
            assert_eq!(histogram.standard_deviation, 0.0);
            assert!((area(&histogram) - 1.0).abs() < 1e-6, "{histogram:?}");
        }
        let mut spike = vec![0.0; 1_000_000];
        spike[3] = 1e6;
        let histogram = Histogram::of(&spike).unwrap();
        assert_eq!(histogram.density.len(), *BINS.end());
        assert_eq!(Histogram::of(&[f64::NAN]), None);
    }
}
