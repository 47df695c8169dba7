//! Curves of time series: gaps stay gaps, and a long log is drawn with as many points as the figure has pixels.

use std::ops::Range;

use model_lab::result::{Residual, Traces};
use recording::{Recording, Trace};

/// Instant (s) and value.
pub(super) type Point = (f64, f64);

/// Returns measured minus free run of a comparison; `None` if the signal is not compared.
pub(super) fn free_run_residual<'a>(traces: &'a Traces, name: &str) -> Option<Trace<'a>> {
    residual(&traces.free_run, name, traces.free_run_residual(name)?)
}

/// Returns measured minus one-step-ahead prediction of a comparison; `None` if there is no such prediction.
pub(super) fn one_step_ahead_residual<'a>(traces: &'a Traces, name: &str) -> Option<Trace<'a>> {
    let residuals = traces.one_step_ahead_residual(name)?;
    residual(&traces.one_step_ahead, name, residuals)
}

fn residual<'a>(model: &'a Recording, name: &str, residual: Residual<'_>) -> Option<Trace<'a>> {
    Trace::on(model, name, residual.iter().collect())
}

/// Returns the squares of the values, 0 where missing, to find where a series is large.
pub(super) fn squares(trace: &Trace<'_>) -> impl Iterator<Item = Point> {
    let square = |value: &f64| if value.is_nan() { 0.0 } else { value * value };
    let instants_s = trace.times_s().iter().copied();
    instants_s.zip(trace.values().iter().map(square))
}

/// Returns lines from sample to sample, broken at gaps; a sample between gaps becomes a dash.
pub(super) fn lines(trace: &Trace<'_>, window_s: &Range<f64>, columns: usize) -> Vec<Vec<Point>> {
    let own = trace.at_own_rows();
    pieces(&own, window_s, columns)
        .into_iter()
        .map(|points| match points[..] {
            [alone] => dash(alone, window_s),
            _ => without_level_points(points),
        })
        .collect()
}

/// Returns a step line: a value applies until the next sample, like a command.
pub(super) fn stairs(trace: &Trace<'_>, window_s: &Range<f64>, columns: usize) -> Vec<Vec<Point>> {
    let own = trace.at_own_rows();
    let stairs_of = |points: Vec<Point>| {
        let ends_s = points.iter().skip(1).map(|next| next.0);
        let last_s = points.last().map(|last| last.0 + own.step_s());
        let corners = points.iter().zip(ends_s.chain(last_s));
        let inside = corners.filter(|((from_s, _), _)| *from_s < window_s.end);
        let stair = |(&(from_s, value), to_s): (&Point, f64)| {
            [(from_s, value), (to_s.min(window_s.end), value)]
        };
        without_level_points(inside.flat_map(stair).collect())
    };
    let pieces = pieces(&own, window_s, columns);
    pieces.into_iter().map(stairs_of).collect()
}

/// Returns the points of the window between its gaps.
fn pieces(trace: &Trace<'_>, window_s: &Range<f64>, columns: usize) -> Vec<Vec<Point>> {
    let shown = trace.decimated(trace.rows(window_s), columns);
    let pieces = shown.split(|row| row.is_none());
    let point = |row: &usize| (trace.times_s()[*row], trace.values()[*row]);
    pieces
        .map(|rows| rows.iter().flatten().map(point).collect::<Vec<_>>())
        .filter(|points| !points.is_empty())
        .collect()
}

/// Returns a visible line for a sample without neighbours: 1/200 of the window.
fn dash((time_s, value): Point, window_s: &Range<f64>) -> Vec<Point> {
    let half_s = (window_s.end - window_s.start) / 400.0;
    [time_s - half_s, time_s + half_s]
        .map(|time_s| (time_s.clamp(window_s.start, window_s.end), value))
        .to_vec()
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use recording::{Provenance, TimeBase, Unit};

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
        super::lines(&trace, &trace.window_s(), columns)
    }

    proptest! {
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
        assert_eq!(stairs(&trace, &(0.0..1.0), 1000).len(), 1);
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
        let corners = stairs(&trace, &(0.0..0.03), 100).concat();
        let values: Vec<f64> = corners.iter().map(|corner| corner.1).collect();
        assert_eq!(values, [0.0, 0.0, 50.0, 50.0, 0.0, 0.0]);
        assert_eq!(corners[1].0, corners[2].0, "the edge is upright");
    }
}
