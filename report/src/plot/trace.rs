//! Time series as line segments: gaps stay gaps, and a long log is thinned without losing an extreme.

use std::borrow::Cow;
use std::ops::Range;

use model_lab::result::Traces;
use recording::{OwnSamples, Recording, Sampling, Unit, median_step_s};

/// Instant (s) and value.
pub(super) type Point = (f64, f64);

/// Values over time; NaN is a missing sample.
#[derive(Clone, Debug)]
pub(super) struct Trace<'a> {
    times_s: Cow<'a, [f64]>,
    values: Vec<f64>,
    /// Median sample interval (s).
    step_s: f64,
}

impl<'a> Trace<'a> {
    /// Returns the signal `name` in its own unit; `None` if it is not recorded.
    pub(super) fn of(recording: &'a Recording, name: &str) -> Option<Self> {
        let values = recording.signal(name)?.values_or_nan().to_vec();
        Self::on(recording, name, values)
    }

    /// Returns the signal `name` in `unit`; `None` if it is not recorded or has another quantity.
    pub(super) fn of_in(recording: &'a Recording, name: &str, unit: Unit) -> Option<Self> {
        let values = recording.signal(name)?.values_in(unit).ok()?;
        Self::on(recording, name, values)
    }

    /// Returns measured minus free run of a comparison; `None` if the signal is not compared.
    pub(super) fn of_free_run_residual(traces: &'a Traces, name: &str) -> Option<Self> {
        let values = traces.free_run_residual(name)?.iter().collect();
        Self::on(&traces.free_run, name, values)
    }

    /// Returns measured minus one-step-ahead prediction of a comparison; `None` if there is no such prediction.
    pub(super) fn of_one_step_ahead_residual(traces: &'a Traces, name: &str) -> Option<Self> {
        let values = traces.one_step_ahead_residual(name)?.iter().collect();
        Self::on(&traces.one_step_ahead, name, values)
    }

    fn on(recording: &'a Recording, name: &str, values: Vec<f64>) -> Option<Self> {
        let base = recording.time_base_of(name)?;
        Some(Self {
            times_s: Cow::Borrowed(base.times_s()),
            values,
            step_s: base.sampling().median_step_s.unwrap_or(1.0),
        })
    }

    /// Returns the sum with another series of the same instants; `None` if the number of samples differs.
    pub(super) fn plus(&self, other: &Trace<'_>) -> Option<Self> {
        (self.values.len() == other.values.len()).then(|| {
            let pairs = self.values.iter().zip(&other.values);
            Self {
                values: pairs.map(|(a, b)| a + b).collect(),
                ..self.clone()
            }
        })
    }

    /// Multiplies every value by `factor`.
    pub(super) fn times(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    /// Returns the range from the first instant to the end of the last sample (s).
    pub(super) fn window_s(&self) -> Range<f64> {
        let start_s = self.times_s.first().copied().unwrap_or(0.0);
        let end_s = self.times_s.last().copied().unwrap_or(0.0);
        start_s..end_s + self.step_s
    }

    /// Returns the median sample interval (s).
    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Returns the smallest and largest value in the window; `None` without samples.
    pub(super) fn extent(&self, window_s: &Range<f64>) -> Option<Range<f64>> {
        self.rows(window_s)
            .map(|row| self.values[row])
            .filter(|value| !value.is_nan())
            .fold(None, |extent, value| {
                let Range { start, end } = extent.unwrap_or(value..value);
                Some(start.min(value)..end.max(value))
            })
    }

    /// Returns the cumulative sum of squares, to find where a series is large.
    pub(super) fn squares(&self) -> impl Iterator<Item = Point> + '_ {
        let square = |value: &f64| if value.is_nan() { 0.0 } else { value * value };
        self.times_s
            .iter()
            .copied()
            .zip(self.values.iter().map(square))
    }

    /// Returns lines from sample to sample, broken at missing samples; a sample between missing ones becomes a dash.
    pub(super) fn lines(&self, window_s: &Range<f64>, columns: usize) -> Vec<Vec<Point>> {
        let own = self.at_own_rows();
        let point = |row: usize| (own.times_s[row], own.values[row]);
        own.pieces(window_s)
            .into_iter()
            .map(|rows| match rows.len() {
                1 => dash(point(rows.start), window_s),
                _ => drawn(&rows.map(point).collect::<Vec<_>>(), window_s, columns),
            })
            .collect()
    }

    /// Returns a step line: a value applies until the next sample, like a command.
    pub(super) fn stairs(&self, window_s: &Range<f64>, columns: usize) -> Vec<Vec<Point>> {
        let own = self.at_own_rows();
        let begins_inside = |row: &usize| own.times_s[*row] < window_s.end;
        let stair = |row: usize, end: usize| {
            let from_s = own.times_s[row];
            let to_s = if row + 1 < end {
                own.times_s[row + 1]
            } else {
                from_s + own.step_s
            };
            [
                (from_s, own.values[row]),
                (to_s.min(window_s.end), own.values[row]),
            ]
        };
        own.pieces(window_s)
            .into_iter()
            .map(|rows| {
                let end = rows.end;
                let points: Vec<_> = rows
                    .filter(begins_inside)
                    .flat_map(|row| stair(row, end))
                    .collect();
                drawn(&points, window_s, columns)
            })
            .collect()
    }

    /// Returns the series at the instants at which it was sampled, if it has a lower rate than its rows.
    fn at_own_rows(&self) -> Cow<'_, Self> {
        match OwnSamples::of(&self.times_s, &self.values) {
            None => Cow::Borrowed(self),
            Some(own) => Cow::Owned(Self {
                step_s: median_step_s(&own.times_s).unwrap_or(self.step_s),
                times_s: Cow::Owned(own.times_s),
                values: own.values,
            }),
        }
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

    /// Returns the ranges of rows without a missing sample or a drop-out.
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

/// Returns a visible line for a sample without neighbours: 1/200 of the window.
fn dash((time_s, value): Point, window_s: &Range<f64>) -> Vec<Point> {
    let half_s = (window_s.end - window_s.start) / 400.0;
    [time_s - half_s, time_s + half_s]
        .map(|time_s| (time_s.clamp(window_s.start, window_s.end), value))
        .to_vec()
}

/// Returns the points that a line needs.
fn drawn(points: &[Point], window_s: &Range<f64>, columns: usize) -> Vec<Point> {
    thinned(&without_level_points(points.to_vec()), window_s, columns)
}

/// Keeps the ends of each level segment only, which leaves the drawn line unchanged.
fn without_level_points(mut points: Vec<Point>) -> Vec<Point> {
    let mut kept = 0;
    for row in 0..points.len() {
        let is_level = kept >= 2
            && points[kept - 2].1 == points[kept - 1].1
            && points[kept - 1].1 == points[row].1;
        let place = if is_level { kept - 1 } else { kept };
        points[place] = points[row];
        kept = place + 1;
    }
    points.truncate(kept);
    points
}

/// Keeps at most two points per pixel column: the smallest and the largest, in their order. A line through them covers
/// the same pixels as one through all points, so that no peak is lost.
fn thinned(points: &[Point], window_s: &Range<f64>, columns: usize) -> Vec<Point> {
    if points.len() <= 2 * columns {
        return points.to_vec();
    }
    let length_s = window_s.end - window_s.start;
    let column = |point: &Point| ((point.0 - window_s.start) / length_s * columns as f64) as usize;
    let extremes = |group: &[Point]| {
        let by_value = |a: &usize, b: &usize| group[*a].1.total_cmp(&group[*b].1);
        let rows = 0..group.len();
        let least = rows.clone().min_by(by_value).unwrap_or(0);
        let greatest = rows.max_by(by_value).unwrap_or(0);
        let both = (least != greatest).then(|| group[least.max(greatest)]);
        [Some(group[least.min(greatest)]), both]
    };
    points
        .chunk_by(|a, b| column(a) == column(b))
        .flat_map(extremes)
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use recording::{Provenance, TimeBase};

    use super::*;

    fn recording_of(values: Vec<f64>) -> Recording {
        let mut recording = Recording::new(Provenance::from_source("made up"));
        let times = TimeBase::uniform(0.0, 0.01, values.len()).unwrap();
        let times = recording.add_time_base(times);
        recording
            .add_signal("p_ch", Unit::BarGauge, times, values)
            .unwrap();
        recording
    }

    fn lines(recording: &Recording, columns: usize) -> Vec<Vec<Point>> {
        let trace = Trace::of(recording, "p_ch").unwrap();
        trace.lines(&trace.window_s(), columns)
    }

    proptest! {
        /// Goal: a peak of a single sample is visible in a log of any length. Method: in each pixel column the drawn
        /// points have the minimum and maximum of all samples, and every drawn point is a sample.
        #[test]
        fn thinning_keeps_the_extremes_of_every_column(
            values in prop::collection::vec(prop_oneof![Just(0.0), -9.0..9.0], 1..2000),
            columns in 1_usize..80,
        ) {
            let end_s = values.len() as f64 * 0.01;
            let window_s = 0.0..end_s;
            let points: Vec<Point> = values.iter().enumerate().map(|(row, value)| (row as f64 * 0.01, *value)).collect();
            let drawn = thinned(&points, &window_s, columns);
            prop_assert!(drawn.len() <= 2 * columns);
            prop_assert!(drawn.iter().all(|point| points.contains(point)));
            prop_assert!(drawn.windows(2).all(|pair| pair[0].0 < pair[1].0));
            let reach = |points: &[Point], column: usize| {
                let in_column = |point: &&Point| (point.0 / end_s * columns as f64) as usize == column;
                let values = points.iter().filter(in_column).map(|point| point.1);
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), value| (value.min(least), value.max(greatest)))
            };
            for column in 0..columns {
                prop_assert_eq!(reach(&drawn, column), reach(&points, column), "column {}", column);
            }
        }

        /// Goal: dropping the middle of level segments changes no line. Method: every dropped point lies between two
        /// kept ones of its own value.
        #[test]
        fn only_points_on_a_level_line_are_left_out(values in prop::collection::vec(0_u8..3, 1..200)) {
            let points: Vec<Point> = values.iter().enumerate().map(|(row, value)| (row as f64, f64::from(*value))).collect();
            let kept = without_level_points(points.clone());
            for point in &points {
                let after = kept.partition_point(|kept| kept.0 < point.0);
                let is_kept = kept.get(after) == Some(point);
                let is_between = after > 0 && after < kept.len() && kept[after - 1].1 == point.1 && kept[after].1 == point.1;
                prop_assert!(is_kept || is_between, "{:?} in {:?}", point, kept);
            }
            prop_assert_eq!(kept.first(), points.first());
            prop_assert_eq!(kept.last(), points.last());
        }
    }

    #[test]
    fn a_missing_sample_breaks_the_line() {
        let recording = recording_of(vec![1.0, 2.0, f64::NAN, 3.0, 4.0, f64::NAN]);
        assert_eq!(
            lines(&recording, 100),
            [
                vec![(0.0, 1.0), (0.01, 2.0)],
                vec![(0.03, 3.0), (0.04, 4.0)]
            ]
        );
    }

    /// Defect seen: the duty cycles of a log with empty cells between its commands were drawn as separate dashes.
    #[test]
    fn a_signal_of_a_lower_rate_is_one_line() {
        let value = |row: usize| match row % 5 {
            0 => row as f64,
            _ => f64::NAN,
        };
        let recording = recording_of((0..100).map(value).collect());
        let [line] = &lines(&recording, 1000)[..] else {
            panic!("{:?}", lines(&recording, 1000));
        };
        assert_eq!(line.len(), 20);
        let trace = Trace::of(&recording, "p_ch").unwrap();
        assert_eq!(trace.stairs(&(0.0..1.0), 1000).len(), 1);
    }

    #[test]
    fn a_sample_between_missing_ones_is_seen() {
        let recording = recording_of(vec![1.0, f64::NAN, 3.0, f64::NAN]);
        let dashes = lines(&recording, 100);
        assert_eq!(dashes.len(), 2);
        for (dash, time_s, value) in [(&dashes[0], 0.0, 1.0), (&dashes[1], 0.02, 3.0)] {
            let [begin, end] = dash[..] else {
                panic!("{dash:?}")
            };
            assert!(begin.0 <= time_s && time_s < end.0, "{dash:?}");
            assert_eq!((begin.1, end.1), (value, value));
        }
    }

    #[test]
    fn a_drop_out_of_the_logger_breaks_the_line() {
        let mut recording = Recording::new(Provenance::from_source("made up"));
        let times = TimeBase::new(vec![0.0, 0.01, 0.02, 0.5, 0.51]).unwrap();
        let times = recording.add_time_base(times);
        recording
            .add_signal("p_ch", Unit::BarGauge, times, vec![0.0, 1.0, 2.0, 3.0, 4.0])
            .unwrap();
        let pieces = lines(&recording, 100);
        assert_eq!(pieces.iter().map(Vec::len).collect::<Vec<_>>(), [3, 2]);
    }

    #[test]
    fn a_command_holds_until_the_next_one() {
        let recording = recording_of(vec![0.0, 50.0, 0.0]);
        let trace = Trace::of(&recording, "p_ch").unwrap();
        let corners = trace.stairs(&(0.0..0.03), 100).concat();
        let values: Vec<f64> = corners.iter().map(|corner| corner.1).collect();
        assert_eq!(values, [0.0, 0.0, 50.0, 50.0, 0.0, 0.0]);
        assert_eq!(corners[1].0, corners[2].0, "the edge is upright");
    }
}
