//! Repeated readings: the same value for longer than the noise of its sensor lets it stay, because the converter is at its end or the logger
//! got no new value. Without them, a sensor that ends below the supply pressure looks like a chamber that gives way to the pressure. They
//! count as missing.
//!
//! The lowest value of a signal may repeat: many sensors and loggers end at zero, where a chamber rests.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;

use crate::metrics::present;
use crate::noise_floor::Floor;

/// Least noise over the step of the converter at which repeated readings say something.
const NOISE_MIN_STEPS: f64 = 0.5;
/// Probability of such a run anywhere in a log with a live sensor.
const BY_CHANCE: f64 = 1e-6;
/// Fewest readings of such a run, where noise is finer than the converter.
const FEWEST: f64 = 8.0;
/// Share of the samples above which the signal is as it is.
const SHARE_MAX: f64 = 0.5;

/// Readings with the same value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Repeat {
    /// Rows from the first to the last of them.
    pub(crate) rows: Range<usize>,
    pub(crate) value: f64,
}

/// Returns the repeated readings of `values`, and replaces all of a run by NaN except the first one. Where a run has the largest value, the
/// converter ends there, and every reading of this value is replaced.
pub(crate) fn take_out_repeats(values: &mut [f64], floor: &Floor) -> Vec<Repeat> {
    let step = floor.summary.quantisation_step.unwrap_or(0.0);
    if step == 0.0 || floor.sigma < NOISE_MIN_STEPS * step {
        return Vec::new();
    }
    // Runs of each length: a list of all runs would take more memory than the log.
    let mut lengths: BTreeMap<usize, usize> = BTreeMap::new();
    for (_, length) in runs(values) {
        *lengths.entry(length).or_default() += 1;
    }
    let total: usize = lengths.values().sum();
    let known: usize = lengths.iter().map(|(length, runs)| length * runs).sum();
    // A sensor may be slower than its logger, which then repeats each value.
    let mut shorter = 0;
    let usual = lengths.iter().find_map(|(&length, runs)| {
        shorter += runs;
        (2 * shorter >= total).then_some(length)
    });
    let Some(usual) = usual else {
        return Vec::new();
    };
    // Largest probability that the next reading is the same: the density of normal noise at its mean; but noise may be smaller in places.
    let of_noise = step / (floor.sigma * (2.0 * PI).sqrt());
    let repeated: usize = lengths.range(2 * usual..).map(|(_, runs)| runs).sum();
    let same = of_noise.max(repeated as f64 / total as f64);
    let longest = (BY_CHANCE / known as f64).ln() / same.ln() * usual as f64;
    let longest = longest.max(FEWEST);
    let least = present(values).fold(f64::INFINITY, f64::min);
    let found: Vec<Repeat> = runs(values)
        .filter(|(rows, length)| *length as f64 > longest && values[rows.start] != least)
        .map(|(rows, _)| Repeat {
            value: values[rows.start],
            rows,
        })
        .collect();
    let samples: usize = found.iter().map(|repeat| repeat.rows.len()).sum();
    if samples as f64 > SHARE_MAX * known as f64 {
        return Vec::new();
    }
    let most = present(values).fold(f64::NEG_INFINITY, f64::max);
    let is_at_end = found.iter().any(|repeat| repeat.value == most);
    for repeat in &found {
        values[repeat.rows.start + 1..repeat.rows.end].fill(f64::NAN);
    }
    if is_at_end {
        let at_end = values.iter_mut().filter(|value| **value == most);
        at_end.for_each(|value| *value = f64::NAN);
    }
    found
}

/// Returns the runs of equal values, with their number; missing values interrupt none.
fn runs(values: &[f64]) -> impl Iterator<Item = (Range<usize>, usize)> {
    let mut known = (0..values.len())
        .filter(|&row| !values[row].is_nan())
        .peekable();
    std::iter::from_fn(move || {
        let first = known.next()?;
        let (mut end, mut length) = (first + 1, 1);
        while let Some(row) = known.next_if(|&row| values[row] == values[first]) {
            (end, length) = (row + 1, length + 1);
        }
        Some((first..end, length))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{quantise, shut_for};
    use crate::noise::Noise;
    use crate::noise_floor::{Quiet, noise_floor};

    /// Readings at rest with a noise of `sigma`, each repeated `times` times.
    fn at_rest(sigma: f64, times: usize) -> Vec<f64> {
        let mut noise = Noise::new(7);
        let readings = (0..4000 / times).map(|_| quantise(3.0 + sigma * noise.normal(), 5e-3));
        readings.flat_map(|one| vec![one; times]).collect()
    }

    fn taken_out(values: &mut [f64]) -> Vec<Repeat> {
        let floor = noise_floor(values, "bar", Quiet::Hold, &shut_for(values.len(), 0.005));
        take_out_repeats(values, &floor)
    }

    /// Defect seen: a sensor that ends at 6.5 bar got the name of a chamber that grows with the pressure, with 97 % of the error explained.
    #[test]
    fn a_converter_at_its_end_and_a_frozen_value_count_as_missing() {
        let mut values = at_rest(4e-3, 1);
        values[100..400].fill(6.5);
        values[1000..1080].fill(4.0);
        let expected = [(100..400, 6.5), (1000..1080, 4.0)];
        let expected = expected.map(|(rows, value)| Repeat { rows, value });
        assert_eq!(taken_out(&mut values), expected);
        assert!(values[100..400].iter().all(|value| value.is_nan()));
        assert_eq!(values[1000], 4.0);
        assert_eq!(present(&values).count(), 4000 - 300 - 79);
    }

    #[test]
    fn a_live_sensor_keeps_every_reading() {
        for (sigma, times) in [(2.5e-3, 1), (4e-3, 1), (4e-3, 10), (20e-3, 1), (1e-3, 1)] {
            let mut values = at_rest(sigma, times);
            assert_eq!(taken_out(&mut values), [], "{sigma} {times}");
        }
        // Zero is the end of many sensors, and where a chamber rests.
        let mut values = at_rest(4e-3, 1);
        values[..300].fill(0.0);
        assert_eq!(taken_out(&mut values), []);
    }
}
