//! Points of a time series in a view: as many as the page has pixels.

use recording::{Pyramid, Samples, Sampling, TimeBase, Trace};
use serde::{Deserialize, Serialize};

use crate::refusal::Refusal;

/// Largest number of points that a page may request.
const POINTS_MAX: usize = 8000;

/// Interval of a log's time (s).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub(in crate::pages) struct Range {
    pub(in crate::pages) from_s: Option<f64>,
    pub(in crate::pages) to_s: Option<f64>,
}

impl Range {
    /// Returns the range extended by `share` of its width on either side.
    pub(in crate::pages) fn with_beside(self, share: f64) -> Result<Self, Refusal> {
        if !(0.0..=1.0).contains(&share) {
            return Err(Refusal::value(format!(
                "the margin of a view is {share} of its width (0 to 1)"
            )));
        }
        let (Some(from_s), Some(to_s)) = (self.from_s, self.to_s) else {
            return Ok(self);
        };
        let beside_s = share * (to_s - from_s);
        Ok(Self {
            from_s: Some(from_s - beside_s),
            to_s: Some(to_s + beside_s),
        })
    }

    /// Returns the indices of the instants within, and the range in s.
    pub(in crate::pages) fn of(
        self,
        base: &TimeBase,
    ) -> Result<(std::ops::Range<usize>, (f64, f64)), Refusal> {
        let from_s = self.from_s.unwrap_or(base.start_s());
        let to_s = self.to_s.unwrap_or(base.end_s());
        if !(from_s.is_finite() && to_s.is_finite() && from_s <= to_s) {
            return Err(Refusal::value(format!(
                "the view from {from_s} s to {to_s} s is not a range; its end must not be before its start"
            )));
        }
        let times_s = base.times_s();
        let first = times_s.partition_point(|&time_s| time_s < from_s);
        let last = times_s.partition_point(|&time_s| time_s <= to_s);
        Ok((first..last, (from_s, to_s)))
    }
}

/// Part of a log that a page draws.
#[derive(Clone, Copy)]
pub(in crate::pages) struct Drawn {
    pub(in crate::pages) range: Range,
    /// Number of points of each series, about.
    pub(in crate::pages) points: usize,
}

/// Points of a series; null is a gap.
#[derive(Default, Serialize)]
pub(in crate::pages) struct Points {
    t: Vec<Option<f64>>,
    y: Vec<Option<f64>>,
}

impl Points {
    /// Returns the points of `values`, with the samples next to the drawn range; their pyramid is made on request.
    pub(in crate::pages) fn of(
        base: &TimeBase,
        values: impl Samples,
        drawn: Drawn,
    ) -> Result<Self, Refusal> {
        Self::new(base, values, None, drawn)
    }

    /// Returns the same as [`Points::of`] from the pyramid of the values.
    pub(in crate::pages) fn of_pyramid(
        base: &TimeBase,
        values: impl Samples,
        pyramid: &Pyramid,
        drawn: Drawn,
    ) -> Result<Self, Refusal> {
        Self::new(base, values, Some(pyramid), drawn)
    }

    fn new(
        base: &TimeBase,
        values: impl Samples,
        pyramid: Option<&Pyramid>,
        drawn: Drawn,
    ) -> Result<Self, Refusal> {
        let (within, _) = drawn.range.of(base)?;
        let times_s = base.times_s();
        let rows = within.start.saturating_sub(1)..(within.end + 1).min(times_s.len());
        let columns = drawn.points.clamp(2, POINTS_MAX) / 2;
        // The mean interval is used because the median of the whole log may be unknown.
        let trace = Trace::new(times_s, values, mean_step_s(base));
        let shown = match pyramid {
            Some(pyramid) => trace.decimated_by(pyramid, rows, columns),
            None => trace.decimated(rows, columns),
        };
        let each = |value: &dyn Fn(usize) -> f64| shown.iter().map(|row| row.map(value)).collect();
        Ok(Self {
            t: each(&|row| times_s[row]),
            y: each(&|row| trace.values().value(row)),
        })
    }

    /// Changes every value.
    pub(in crate::pages) fn map(mut self, change: impl Fn(f64) -> f64) -> Self {
        for value in self.y.iter_mut().flatten() {
            *value = change(*value);
        }
        self
    }
}

/// Returns the shortest pause of a log (s).
pub(in crate::pages) fn gap_s(base: &TimeBase) -> f64 {
    mean_step_s(base) * Sampling::GAP_IN_MEDIAN_STEPS
}

/// Returns the mean distance of two instants (s): a cheap bound for gaps.
fn mean_step_s(base: &TimeBase) -> f64 {
    (base.end_s() - base.start_s()) / (base.len().max(2) - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_view_has_every_sample_and_its_neighbours() {
        let base = TimeBase::uniform(0.0, 0.001, 10_000).unwrap();
        let values: Vec<f64> = (0..10_000).map(f64::from).collect();
        let range = Range {
            from_s: Some(5.0005),
            to_s: Some(5.0025),
        };
        let points = Points::of(&base, &values[..], Drawn { range, points: 800 }).unwrap();
        assert_eq!(points.y, [5000.0, 5001.0, 5002.0, 5003.0].map(Some));
    }
}
