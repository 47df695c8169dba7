//! The course of a signal as line segments: gaps stay gaps, and a long log is thinned without losing an extreme.

use std::ops::Range;

use recording::{Recording, Sampling, Unit};

/// A point: instant \[s\] and value.
pub(super) type Point = (f64, f64);

/// Values over time; NaN is a missing sample.
#[derive(Clone, Debug)]
pub(super) struct Course<'a> {
    times_s: &'a [f64],
    values: Vec<f64>,
    /// Median distance of two samples \[s\].
    step_s: f64,
}

impl<'a> Course<'a> {
    /// The signal `name` in its own unit, none where it is not recorded.
    pub(super) fn of(recording: &'a Recording, name: &str) -> Option<Self> {
        let values = recording.signal(name)?.values_or_nan().to_vec();
        Self::on(recording, name, values)
    }

    /// The signal `name` in `unit`, none where it is not recorded or is something else.
    pub(super) fn of_in(recording: &'a Recording, name: &str, unit: Unit) -> Option<Self> {
        let values = recording.signal(name)?.values_in(unit).ok()?;
        Self::on(recording, name, values)
    }

    fn on(recording: &'a Recording, name: &str, values: Vec<f64>) -> Option<Self> {
        let base = recording.time_base_of(name)?;
        Some(Self {
            times_s: base.times_s(),
            values,
            step_s: base.sampling().median_step_s.unwrap_or(1.0),
        })
    }

    /// Sample by sample with another course of the same instants; none where their number differs.
    pub(super) fn plus(&self, other: &Course<'_>) -> Option<Self> {
        (self.values.len() == other.values.len()).then(|| {
            let pairs = self.values.iter().zip(&other.values);
            Self {
                values: pairs.map(|(a, b)| a + b).collect(),
                ..self.clone()
            }
        })
    }

    /// Every value times `factor`.
    pub(super) fn times(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    /// First and last instant \[s\].
    pub(super) fn window_s(&self) -> Range<f64> {
        let start_s = self.times_s.first().copied().unwrap_or(0.0);
        let end_s = self.times_s.last().copied().unwrap_or(0.0);
        start_s..end_s.max(start_s + self.step_s)
    }

    /// Least and greatest value in the window; none where nothing was sampled.
    pub(super) fn extent(&self, window_s: &Range<f64>) -> Option<Range<f64>> {
        self.rows(window_s)
            .map(|row| self.values[row])
            .filter(|value| !value.is_nan())
            .fold(None, |extent, value| {
                let Range { start, end } = extent.unwrap_or(value..value);
                Some(start.min(value)..end.max(value))
            })
    }

    /// Sum of the squares from row to row, to find where a course is large.
    pub(super) fn squares(&self) -> impl Iterator<Item = Point> + '_ {
        let square = |value: &f64| if value.is_nan() { 0.0 } else { value * value };
        self.times_s
            .iter()
            .copied()
            .zip(self.values.iter().map(square))
    }

    /// Lines from sample to sample, broken where samples are missing.
    pub(super) fn lines(&self, window_s: &Range<f64>, columns: usize) -> Vec<Vec<Point>> {
        let point = |row: usize| (self.times_s[row], self.values[row]);
        self.pieces(window_s)
            .into_iter()
            .map(|rows| thinned(&rows.map(point).collect::<Vec<_>>(), window_s, columns))
            .collect()
    }

    /// Stairs: a value holds until the next sample, as a command does.
    pub(super) fn stairs(&self, window_s: &Range<f64>, columns: usize) -> Vec<Vec<Point>> {
        let stair = |row: usize, end: usize| {
            let from_s = self.times_s[row];
            let to_s = if row + 1 < end {
                self.times_s[row + 1]
            } else {
                from_s + self.step_s
            };
            [
                (from_s, self.values[row]),
                (to_s.min(window_s.end), self.values[row]),
            ]
        };
        self.pieces(window_s)
            .into_iter()
            .map(|rows| {
                let end = rows.end;
                let points: Vec<_> = rows.flat_map(|row| stair(row, end)).collect();
                thinned(&points, window_s, columns)
            })
            .collect()
    }

    fn rows(&self, window_s: &Range<f64>) -> Range<usize> {
        let from = self
            .times_s
            .partition_point(|&time_s| time_s < window_s.start);
        let to = self
            .times_s
            .partition_point(|&time_s| time_s <= window_s.end);
        from..to.max(from)
    }

    /// Rows without a missing sample or a drop-out between them.
    fn pieces(&self, window_s: &Range<f64>) -> Vec<Range<usize>> {
        let longest_s = self.step_s * Sampling::GAP_IN_MEDIAN_STEPS;
        let mut pieces: Vec<Range<usize>> = Vec::new();
        for row in self
            .rows(window_s)
            .filter(|&row| !self.values[row].is_nan())
        {
            let continues = |piece: &&mut Range<usize>| {
                piece.end == row && self.times_s[row] - self.times_s[row - 1] <= longest_s
            };
            match pieces.last_mut().filter(continues) {
                Some(piece) => piece.end = row + 1,
                None => pieces.push(row..row + 1),
            }
        }
        pieces
    }
}

/// At most four points per column of pixels: the first, the least, the greatest and the last, in their order. A line
/// through them covers the same pixels as one through all points, so that no peak is lost.
fn thinned(points: &[Point], window_s: &Range<f64>, columns: usize) -> Vec<Point> {
    let length_s = window_s.end - window_s.start;
    let column = |point: &Point| ((point.0 - window_s.start) / length_s * columns as f64) as usize;
    if points.len() <= 4 * columns {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(4 * columns);
    for group in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_value = |a: &usize, b: &usize| group[*a].1.total_cmp(&group[*b].1);
        let least = (0..group.len()).min_by(by_value).unwrap_or(0);
        let greatest = (0..group.len()).max_by(by_value).unwrap_or(0);
        let mut rows = [0, least, greatest, group.len() - 1];
        rows.sort_unstable();
        let mut last = None;
        for row in rows {
            if last != Some(row) {
                kept.push(group[row]);
            }
            last = Some(row);
        }
    }
    kept
}
