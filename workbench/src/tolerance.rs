//! Tolerance of a model's error, sample by sample: a band around the measured series.
//!
//! The width of the band is the larger of an absolute and a relative tolerance. A time tolerance extends the band to
//! its extremes within that time: a step that comes slightly late is within it.

use std::collections::VecDeque;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::refusal::Refusal;

/// Longest time tolerance (s); for more, a log should be shifted.
const TIME_S_MAX: f64 = 60.0;

/// Tolerance of one signal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tolerance {
    /// Absolute tolerance, in the unit of the residual.
    #[serde(default)]
    pub(crate) absolute: f64,
    /// Relative tolerance, as a share of the measured value.
    #[serde(default)]
    pub(crate) relative: f64,
    #[serde(default)]
    pub(crate) time_s: f64,
    /// Share of the samples that may be beyond the band.
    #[serde(default)]
    pub(crate) beyond_max: f64,
}

impl Tolerance {
    /// Refuses an invalid tolerance.
    pub(crate) fn check(&self, name: &str) -> Result<(), Refusal> {
        let bounds = [
            ("absolute tolerance", self.absolute, f64::MAX),
            ("relative tolerance", self.relative, 1.0),
            ("time tolerance in s", self.time_s, TIME_S_MAX),
            ("share beyond the tolerance", self.beyond_max, 1.0),
        ];
        for (what, value, most) in bounds {
            if !(0.0..=most).contains(&value) {
                let upper = if most < f64::MAX {
                    format!("to {most}")
                } else {
                    "or more".to_owned()
                };
                return Err(Refusal::value(format!(
                    "the {what} of {name} is {value} (0 {upper}); enter a value in this range"
                )));
            }
        }
        if self.absolute == 0.0 && self.relative == 0.0 {
            return Err(Refusal::value(format!(
                "{name} has neither an absolute nor a relative tolerance; enter at least one"
            )));
        }
        Ok(())
    }

    /// Returns the lowest and the highest residual (measured - modelled) within tolerance, for each of `rows`.
    pub(crate) fn bounds(
        &self,
        times_s: &[f64],
        measured: &[f64],
        rows: Range<usize>,
    ) -> [Vec<f64>; 2] {
        let width = |value: f64| self.absolute.max(self.relative * value.abs());
        let upper: Vec<f64> = measured.iter().map(|&value| value + width(value)).collect();
        // The lowest value is the highest of the negated values.
        let lower: Vec<f64> = measured.iter().map(|&value| width(value) - value).collect();
        let highest = highest_around(times_s, &upper, rows.clone(), self.time_s);
        let lowest = highest_around(times_s, &lower, rows.clone(), self.time_s);
        let measured = &measured[rows];
        let below = measured
            .iter()
            .zip(highest)
            .map(|(value, high)| value - high);
        let above = measured.iter().zip(lowest).map(|(value, low)| value + low);
        [below.collect(), above.collect()]
    }
}

/// Returns for each of `rows` the highest value at most `reach_s` away; NaN if there is none.
fn highest_around(times_s: &[f64], values: &[f64], rows: Range<usize>, reach_s: f64) -> Vec<f64> {
    // Decreasing values: a value that is lower and earlier than another one is never the highest again.
    let mut candidates: VecDeque<usize> = VecDeque::new();
    let mut next = times_s.get(rows.start).map_or(0, |first_s| {
        times_s.partition_point(|time_s| *time_s < first_s - reach_s)
    });
    rows.map(|row| {
        while next < values.len() && times_s[next] <= times_s[row] + reach_s {
            if !values[next].is_nan() {
                while candidates
                    .back()
                    .is_some_and(|&last| values[last] <= values[next])
                {
                    candidates.pop_back();
                }
                candidates.push_back(next);
            }
            next += 1;
        }
        let earliest_s = times_s[row] - reach_s;
        while candidates
            .front()
            .is_some_and(|&first| times_s[first] < earliest_s)
        {
            candidates.pop_front();
        }
        candidates.front().map_or(f64::NAN, |&first| values[first])
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tolerance(absolute: f64, relative: f64, time_s: f64) -> Tolerance {
        Tolerance {
            absolute,
            relative,
            time_s,
            beyond_max: 0.0,
        }
    }

    #[test]
    fn the_larger_of_both_tolerances_counts() {
        let [low, high] = tolerance(0.5, 0.1, 0.0).bounds(&[0.0, 1.0], &[2.0, -10.0], 0..2);
        assert_eq!((low, high), (vec![-0.5, -1.0], vec![0.5, 1.0]));
    }

    /// A step from 0 to 10 may come a second early or late.
    #[test]
    fn a_time_tolerance_lets_a_step_come_early_or_late() {
        let times_s: Vec<f64> = (0..8).map(f64::from).collect();
        let measured = [0.0, 0.0, 0.0, 0.0, 10.0, 10.0, 10.0, 10.0];
        let [low, high] = tolerance(1.0, 0.0, 1.0).bounds(&times_s, &measured, 2..6);
        // Before the step the model may already be high, and after the step it may still be low.
        assert_eq!(low, [-1.0, -11.0, -1.0, -1.0]);
        assert_eq!(high, [1.0, 1.0, 11.0, 1.0]);
    }

    #[test]
    fn the_highest_around_is_that_of_all_that_is_near() {
        let times_s: Vec<f64> = (0..500).map(|index| f64::from(index) * 0.1).collect();
        let mut values: Vec<f64> = (0..500)
            .map(|index| f64::from((index * 7919) % 211))
            .collect();
        values[60..80].fill(f64::NAN);
        let found = highest_around(&times_s, &values, 40..90, 0.75);
        for (found, row) in found.into_iter().zip(40..90) {
            let near = (0..500).filter(|&other| (times_s[other] - times_s[row]).abs() <= 0.75);
            let highest = near.map(|other| values[other]).fold(f64::NAN, f64::max);
            assert!(
                found == highest || found.is_nan() && highest.is_nan(),
                "{row}"
            );
        }
    }

    #[test]
    fn what_is_no_tolerance_is_refused() {
        assert!(tolerance(0.1, 0.0, 0.0).check("p_ch").is_ok());
        assert!(tolerance(0.0, 0.02, 0.5).check("p_ch").is_ok());
        for wrong in [
            tolerance(0.0, 0.0, 1.0),
            tolerance(-1.0, 0.0, 0.0),
            tolerance(f64::NAN, 0.1, 0.0),
            tolerance(f64::INFINITY, 0.1, 0.0),
            tolerance(1.0, 1.5, 0.0),
            tolerance(1.0, 0.0, 61.0),
        ] {
            assert!(wrong.check("p_ch").is_err(), "{wrong:?}");
        }
    }
}
