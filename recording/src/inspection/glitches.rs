//! Glitches: a few isolated numbers far from all others of a column.

use std::fmt;
use std::ops::RangeInclusive;

use crate::bounds::Short;
use crate::values::ColumnValues;

/// Least number of numbers among which a glitch can be found.
const NUMBERS_MIN: usize = 50;
/// Number of glitches that is always allowed.
const GLITCHES_MIN: usize = 3;
/// Largest share of glitches.
const SHARE_MAX: f64 = 0.01;
/// Distance of a glitch from the other numbers, in their range.
const DISTANCE: f64 = 5.0;
/// Longest glitch, in consecutive numbers.
const LENGTH_MAX: usize = 3;

/// Glitches of a column, and the range of its other numbers.
#[derive(Clone, Debug)]
pub(super) struct Glitches {
    /// Glitches in the order of the file.
    pub(super) cells: Vec<f64>,
    /// Statistics without the glitches.
    pub(super) others: ColumnValues,
    /// Range of the other numbers, widened by its length on both sides.
    pub(super) range: RangeInclusive<f64>,
}

impl Glitches {
    /// Finds the glitches among the numbers of a column, NaN where missing; `None` if there are none.
    pub(super) fn find(samples: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = samples.iter().copied().filter(|it| !it.is_nan()).collect();
        if sorted.len() < NUMBERS_MIN {
            return None;
        }
        sorted.sort_unstable_by(f64::total_cmp);
        let count_max = GLITCHES_MIN.max((SHARE_MAX * sorted.len() as f64) as usize);
        let (least, greatest) = (sorted[count_max], sorted[sorted.len() - 1 - count_max]);
        let distance = DISTANCE * (greatest - least);
        if distance <= 0.0 {
            return None;
        }
        let is_glitch = |value: f64| value < least - distance || value > greatest + distance;
        let mut others = ColumnValues::default();
        let mut cells = Vec::new();
        let mut length = 0;
        for &value in samples {
            if !is_glitch(value) {
                // A missing cell does not separate two glitches.
                length = if value.is_nan() { length } else { 0 };
                others.add(value);
                continue;
            }
            cells.push(value);
            others.add(f64::NAN);
            length += 1;
            if length > LENGTH_MAX || cells.len() > count_max {
                return None;
            }
        }
        if cells.is_empty() {
            return None;
        }
        let width = others.greatest - others.least;
        let digit = 10_f64.powf(width.log10().floor() - 1.0);
        let least = ((others.least - width) / digit).floor() * digit;
        let greatest = ((others.greatest + width) / digit).ceil() * digit;
        Some(Self {
            cells,
            others,
            range: rounded(least)..=rounded(greatest),
        })
    }
}

/// Returns the number without the error of a product with a power of ten.
fn rounded(value: f64) -> f64 {
    format!("{value:.10e}").parse().unwrap_or(value)
}

impl fmt::Display for Glitches {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (least, greatest) = (Short(*self.range.start()), Short(*self.range.end()));
        let first = Short(self.cells[0]);
        match self.cells.len() {
            1 => write!(
                f,
                "the value {first} is a glitch: outside {least} to {greatest}"
            ),
            count => write!(
                f,
                "{count} values are glitches, the first is {first}: outside {least} to {greatest}"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slow(count: usize) -> Vec<f64> {
        (0..count)
            .map(|row| 3.0 + (0.05 * row as f64).sin())
            .collect()
    }

    #[test]
    fn isolated_far_numbers_are_glitches_and_their_neighbours_are_not() {
        let mut samples = slow(500);
        assert!(Glitches::find(&samples).is_none());
        (samples[100], samples[300]) = (655.35, -999.0);
        let found = Glitches::find(&samples).unwrap();
        assert_eq!(found.cells, [655.35, -999.0]);
        assert_eq!(found.range, 0.0..=6.0);
        assert_eq!((found.others.count, found.others.missing), (498, 2));
        assert!(found.others.are_within(1.9, 4.1));
    }

    /// A burst of pressure is short but no glitch, and neither is half of a log.
    #[test]
    fn a_burst_of_numbers_is_no_glitch() {
        let mut samples = slow(500);
        samples[100..104].fill(50.0);
        assert!(Glitches::find(&samples).is_none());
        assert!(Glitches::find(&vec![1.0; 100]).is_none());
        let jumps: Vec<f64> = (0..100)
            .map(|row| {
                if row % 10 == 0 {
                    500.0
                } else {
                    1.0 + 0.01 * f64::from(row)
                }
            })
            .collect();
        assert!(Glitches::find(&jumps).is_none());
    }
}
