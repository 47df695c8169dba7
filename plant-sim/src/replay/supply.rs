//! Logged supply pressure that drives the plant (E60).

use recording::{Bounds, Quantity, Recording, TimeBase, Unit};

use crate::parameters::{PA_PER_BAR, ParameterSpec, Part, PlantParameters};
use crate::plant::FILL;

/// Name of the signal.
pub const SUPPLY_PRESSURE: &str = "p_sup";

/// Maximum number of averaged samples on either side.
const REACH_MAX: usize = 256;
/// Minimum number of samples for averaging the noise.
const FEWEST: usize = 50;
/// Difference of two samples (Pa) below which it is rounding.
const LEAST_STEP: f64 = 1.0;
/// Share of changing samples above which the smallest difference is the resolution.
const TOGGLES: f64 = 0.05;
/// Half the width of a confidence interval divided by the standard deviation of a mean.
const CONFIDENCE: f64 = 3.0;

/// Returns the lowest and the highest supply pressure (Pa abs) that drives a plant: the lowest pressure that counts as
/// measured, and the highest supply pressure of a plant file.
pub fn supply_bounds(parameters: &PlantParameters) -> (f64, f64) {
    let spec = ParameterSpec::by_name("gas.supply_pressure_bar_gauge");
    let most_bar = spec.map_or(f64::INFINITY, |spec| spec.range.1);
    (
        Bounds::of(Quantity::Pressure).least * PA_PER_BAR,
        most_bar * PA_PER_BAR + parameters.gas.ambient_pressure_pa,
    )
}

/// Returns whether `p_sup` of `log` drives the plant: the plant has a supply, and the signal has a usable value.
///
/// # Errors
/// Returns the reason, a sentence without a full stop, if the log has `p_sup` and it does not drive the plant.
pub fn drives_supply(parameters: &PlantParameters, log: &Recording) -> Result<bool, String> {
    if !log.mentions(SUPPLY_PRESSURE) {
        return Ok(false);
    }
    if !Part::FlowThrough(FILL).is_in(parameters) {
        return Err("the plant has no fill valve that a supply pressure drives".to_owned());
    }
    if let Some(reason) = log.reason_left_out(SUPPLY_PRESSURE) {
        return Err(reason.to_owned());
    }
    let signal = log.require(SUPPLY_PRESSURE, Quantity::Pressure);
    let signal = signal.map_err(|error| error.to_string())?;
    let ambient = parameters.gas.ambient_pressure_pa;
    let values = signal.values_at_ambient(Unit::PascalAbsolute, ambient);
    let values = values.map_err(|error| error.to_string())?;
    let (least, most) = supply_bounds(parameters);
    let is_usable = |value: &f64| (least..=most).contains(value);
    match values.iter().any(is_usable) {
        true => Ok(true),
        false => Err(format!(
            "no sample lies between {:.3} and {:.1} bar absolute; look at its unit",
            least / PA_PER_BAR,
            most / PA_PER_BAR
        )),
    }
}

/// Returns the supply pressure (Pa abs) at the rows of `base`, NaN if the last one stays valid: the reading of the
/// gauge, averaged according to its noise. `None` if the log has none that drives the plant.
pub(super) fn logged_supply(
    parameters: &PlantParameters,
    log: &Recording,
    base: &TimeBase,
) -> Option<Vec<f64>> {
    if !drives_supply(parameters, log).unwrap_or(false) {
        return None;
    }
    let signal = log.signal(SUPPLY_PRESSURE)?;
    let own = log.time_base(signal.time_base())?;
    let ambient = parameters.gas.ambient_pressure_pa;
    let values = signal.values_at_ambient(Unit::PascalAbsolute, ambient);
    let mut values = values.ok()?;
    let (least, most) = supply_bounds(parameters);
    for value in &mut values {
        if !(least..=most).contains(value) {
            *value = f64::NAN;
        }
    }
    let values = averaged(&values);
    if own == base {
        return Some(values);
    }
    let places = last_before(own, base).into_iter();
    Some(
        places
            .map(|place| place.map_or(f64::NAN, |place| values[place]))
            .collect(),
    )
}

/// Returns for each row of `base` the last sample of a signal on the time base `own`, which is valid until the next
/// one; `None` before the first.
pub(super) fn last_before(own: &TimeBase, base: &TimeBase) -> Vec<Option<usize>> {
    let before = |time_s: &f64| own.times_s().partition_point(|own_s| own_s <= time_s);
    let rows = base.times_s().iter();
    rows.map(|time_s| before(time_s).checked_sub(1)).collect()
}

/// Returns each value as the mean of the widest interval about it whose mean agrees with those of all narrower ones:
/// the rule of intersecting confidence intervals (A. Goldenshluger, A. Nemirovski, Math. Methods of Statistics 6 (1997)
/// 135-170). White noise is averaged out; a step or a dip larger than the noise stays.
fn averaged(values: &[f64]) -> Vec<f64> {
    let sigma = noise(values);
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

/// Returns the standard deviation of the noise. It is estimated from the second differences, which a slow pressure
/// cannot cause, and from the resolution. The lower quartile is used, which a supply that dips every other row does not
/// change. 0 for few samples, whose differences may all be real.
fn noise(values: &[f64]) -> f64 {
    let present: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let curvature = |three: &[f64]| (three[0] - 2.0 * three[1] + three[2]).abs();
    let mut curvatures: Vec<f64> = present.windows(3).map(curvature).collect();
    if curvatures.len() < FEWEST {
        return 0.0;
    }
    curvatures.sort_by(f64::total_cmp);
    let steps = present.windows(2).map(|two| (two[1] - two[0]).abs());
    let steps: Vec<f64> = steps.filter(|&step| step > LEAST_STEP).collect();
    let resolved = match steps.len() as f64 > TOGGLES * present.len() as f64 {
        true => steps.iter().copied().fold(f64::INFINITY, f64::min) / 12_f64.sqrt(),
        // A supply that changed now and then.
        false => 0.0,
    };
    // The lower quartile of a normal magnitude is 0.3186 standard deviations; the weights 1, -2, 1 give sqrt(6).
    (curvatures[curvatures.len() / 4] / (0.3186 * 6_f64.sqrt())).max(resolved)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let values = averaged(&noisy(|_| 9e5, 1e3, 2000));
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
        let values = averaged(&noisy(level, 1e3, 2000));
        let rows = 995..1015;
        let left = rms(rows.map(|row| values[row] - level(row)));
        // A tenth of the dip: a mean over it would leave a half.
        assert!(left < 2e3, "{left}");
    }

    #[test]
    fn a_supply_without_noise_is_taken_as_it_is() {
        let values: Vec<f64> = (0..50).map(|row| 9e5 - 100.0 * f64::from(row)).collect();
        for (found, expected) in averaged(&values).iter().zip(&values) {
            assert!((found - expected).abs() < 1.0, "{found} {expected}");
        }
    }
}
