//! Mean of a logged input over its noise.

/// Maximum number of averaged samples on either side.
const REACH_MAX: usize = 256;
/// Minimum number of samples for averaging the noise.
const FEWEST: usize = 50;
/// Share of changing samples above which the smallest difference is the resolution.
const TOGGLES: f64 = 0.05;
/// Half the width of a confidence interval divided by the standard deviation of a mean.
const CONFIDENCE: f64 = 3.0;

/// Properties of an input by which its noise is distinguished from its changes.
pub(super) struct Input {
    /// Weights of the differences of neighbouring samples that the changes do not cause.
    pub(super) differences: &'static [f64],
    /// Difference of two samples below which it is rounding.
    pub(super) least_step: f64,
}

/// Returns each value as the mean of the widest interval about it whose mean agrees with those of all narrower ones:
/// the rule of intersecting confidence intervals (A. Goldenshluger, A. Nemirovski, Math. Methods of Statistics 6 (1997)
/// 135-170). White noise is averaged out; a step or a dip larger than the noise stays.
pub(super) fn averaged(values: &[f64], input: &Input) -> Vec<f64> {
    let sigma = noise(values, input);
    if sigma == 0.0 {
        return values.to_vec();
    }
    // Sums of the values before each row, and their number.
    let mut sums = Vec::with_capacity(values.len() + 1);
    let (mut sum, mut count) = (0.0, 0_u32);
    sums.push((sum, count));
    // Relative to a value of the signal, so that no digits are lost.
    let origin = values.iter().copied().find(|value| value.is_finite());
    let origin = origin.unwrap_or(0.0);
    for value in values {
        if value.is_finite() {
            sum += value - origin;
            count += 1;
        }
        sums.push((sum, count));
    }
    let mean = |row: usize| {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut widest = values[row];
        let mut reach = 0;
        while reach <= REACH_MAX {
            // Symmetric, also near an end: the mean of a trend is its middle.
            if reach > row || row + reach >= values.len() {
                break;
            }
            let (begin, end) = (sums[row - reach], sums[row + reach + 1]);
            let number = f64::from(end.1 - begin.1);
            let mean = (end.0 - begin.0) / number + origin;
            let half = CONFIDENCE * sigma / number.sqrt();
            (low, high) = (low.max(mean - half), high.min(mean + half));
            if low > high {
                break;
            }
            widest = mean;
            reach = (2 * reach).max(1);
        }
        widest
    };
    let rows = values.iter().enumerate();
    rows.map(|(row, value)| {
        if value.is_finite() {
            mean(row)
        } else {
            f64::NAN
        }
    })
    .collect()
}

/// Returns the standard deviation of the noise. It is estimated from the differences, which the changes of the
/// input do not cause, and from the resolution. The lower quartile is used, which a signal that dips every other row does not
/// change. 0 for few samples, whose differences may all be real.
fn noise(values: &[f64], input: &Input) -> f64 {
    let present: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let weights = input.differences;
    let difference = |samples: &[f64]| {
        let weighted = samples
            .iter()
            .zip(weights)
            .map(|(sample, weight)| sample * weight);
        weighted.sum::<f64>().abs()
    };
    let mut differences: Vec<f64> = present.windows(weights.len()).map(difference).collect();
    if differences.len() < FEWEST {
        return 0.0;
    }
    differences.sort_by(f64::total_cmp);
    let steps = present.windows(2).map(|two| (two[1] - two[0]).abs());
    let steps: Vec<f64> = steps.filter(|&step| step > input.least_step).collect();
    let resolved = match steps.len() as f64 > TOGGLES * present.len() as f64 {
        true => steps.iter().copied().fold(f64::INFINITY, f64::min) / 12_f64.sqrt(),
        // A signal that changed now and then.
        false => 0.0,
    };
    // The lower quartile of a normal magnitude is 0.3186 standard deviations.
    let gain = weights
        .iter()
        .map(|weight| weight * weight)
        .sum::<f64>()
        .sqrt();
    (differences[differences.len() / 4] / (0.3186 * gain)).max(resolved)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INPUT: Input = Input {
        differences: &[1.0, -2.0, 1.0],
        least_step: 1.0,
    };

    /// Returns sums of twelve uniform numbers of one linear congruential sequence.
    fn noisy(level: impl Fn(usize) -> f64, sigma: f64, count: usize) -> Vec<f64> {
        let mut seed = 1_u64;
        let mut uniform = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let mut draw = move || (0..12).map(|_| uniform()).sum::<f64>();
        (0..count).map(|row| level(row) + sigma * draw()).collect()
    }

    fn rms(errors: impl ExactSizeIterator<Item = f64>) -> f64 {
        let count = errors.len() as f64;
        (errors.map(|error| error * error).sum::<f64>() / count).sqrt()
    }

    #[test]
    fn noise_of_a_steady_supply_is_averaged_out() {
        let values = averaged(&noisy(|_| 9e5, 1e3, 2000), &INPUT);
        let left = rms(values[200..1800].iter().map(|value| value - 9e5));
        assert!(left < 150.0, "{left}");
    }

    /// A dip by twenty standard deviations of the noise for ten rows.
    #[test]
    fn a_dip_that_stands_out_of_the_noise_stays() {
        let level = |row: usize| {
            if (1000..1010).contains(&row) {
                8.8e5
            } else {
                9e5
            }
        };
        let values = averaged(&noisy(level, 1e3, 2000), &INPUT);
        let rows = 995..1015;
        let left = rms(rows.map(|row| values[row] - level(row)));
        // A tenth of the dip: a mean over it would leave a half.
        assert!(left < 2e3, "{left}");
    }

    #[test]
    fn a_supply_without_noise_is_taken_as_it_is() {
        let values: Vec<f64> = (0..50).map(|row| 9e5 - 100.0 * f64::from(row)).collect();
        for (found, expected) in averaged(&values, &INPUT).iter().zip(&values) {
            assert!((found - expected).abs() < 1.0, "{found} {expected}");
        }
    }
}
