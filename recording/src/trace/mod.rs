//! Time series of one signal, and the few of its samples that a drawing needs.

mod pyramid;

use std::borrow::Cow;
use std::ops::Range;

use crate::{OwnSamples, Recording, Sampling, Unit, median_step_s};

pub use pyramid::Pyramid;

/// Values of a time series, stored or computed.
pub trait Samples {
    /// Returns the number of samples, missing ones included.
    fn count(&self) -> usize;
    /// Returns the sample of a row; NaN where it is missing.
    ///
    /// # Panics
    /// If there is no such row.
    fn value(&self, row: usize) -> f64;
}

impl Samples for [f64] {
    fn count(&self) -> usize {
        self.len()
    }

    fn value(&self, row: usize) -> f64 {
        self[row]
    }
}

impl Samples for Cow<'_, [f64]> {
    fn count(&self) -> usize {
        self.len()
    }

    fn value(&self, row: usize) -> f64 {
        self[row]
    }
}

impl<S: Samples + ?Sized> Samples for &S {
    fn count(&self) -> usize {
        (**self).count()
    }

    fn value(&self, row: usize) -> f64 {
        (**self).value(row)
    }
}

/// Time series of one signal: a value or NaN at each of its instants.
#[derive(Clone, Debug)]
pub struct Trace<'a, S = Cow<'a, [f64]>> {
    times_s: Cow<'a, [f64]>,
    values: S,
    step_s: f64,
}

impl<'a, S: Samples> Trace<'a, S> {
    /// Creates a time series of increasing instants (s), with the usual time between two of them (s). A pause of the log
    /// is [`Sampling::GAP_IN_MEDIAN_STEPS`] times as long.
    ///
    /// # Panics
    /// If the number of values is not that of the instants.
    pub fn new(times_s: impl Into<Cow<'a, [f64]>>, values: S, step_s: f64) -> Self {
        let times_s = times_s.into();
        assert_eq!(times_s.len(), values.count(), "one value for each instant");
        Self {
            times_s,
            values,
            step_s,
        }
    }

    /// Returns the instants (s).
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Returns the values, in the unit of the signal.
    pub fn values(&self) -> &S {
        &self.values
    }

    /// Returns the usual time between two samples (s).
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Returns the shortest pause of the log (s): longer times between two samples are gaps.
    pub fn gap_s(&self) -> f64 {
        self.step_s * Sampling::GAP_IN_MEDIAN_STEPS
    }

    /// Returns the range from the first instant to the end of the last sample (s).
    pub fn window_s(&self) -> Range<f64> {
        let start_s = self.times_s.first().copied().unwrap_or(0.0);
        let end_s = self.times_s.last().copied().unwrap_or(0.0);
        start_s..end_s + self.step_s
    }

    /// Returns the rows from the begin of a window (s) to its end, both included.
    pub fn rows(&self, window_s: &Range<f64>) -> Range<usize> {
        let place = |is_before: &dyn Fn(f64) -> bool| {
            self.times_s.partition_point(|&time_s| is_before(time_s))
        };
        let from = place(&|time_s| time_s < window_s.start);
        let to = place(&|time_s| time_s <= window_s.end);
        from..to.max(from)
    }

    /// Returns the smallest and the largest value in the window; `None` without samples.
    pub fn extent(&self, window_s: &Range<f64>) -> Option<Range<f64>> {
        self.rows(window_s)
            .map(|row| self.values.value(row))
            .filter(|value| !value.is_nan())
            .fold(None, |extent, value| {
                let Range { start, end } = extent.unwrap_or(value..value);
                Some(start.min(value)..end.max(value))
            })
    }

    /// Returns the rows of `rows` that show the series in `columns` columns of equal time: of each column the samples
    /// with the lowest and the highest value, so that no peak is lost; every row if there are at most two for each
    /// column. `None` is a gap: a pause of the log, or a column or row whose samples are missing.
    pub fn decimated(&self, rows: Range<usize>, columns: usize) -> Vec<Option<usize>> {
        if rows.len() <= 2 * columns {
            return self.all(rows);
        }
        self.decimated_by(&Pyramid::new(&self.values), rows, columns)
    }

    /// Returns the same as [`Trace::decimated`] from the pyramid of the values, whose cost depends on the columns and
    /// not on the samples.
    pub fn decimated_by(
        &self,
        pyramid: &Pyramid,
        rows: Range<usize>,
        columns: usize,
    ) -> Vec<Option<usize>> {
        if rows.len() <= 2 * columns {
            return self.all(rows);
        }
        let columns = columns.max(1);
        let begin_s = self.times_s[rows.start];
        let span_s = self.times_s[rows.end - 1] - begin_s;
        let mut shown = Vec::with_capacity(2 * columns);
        let mut from = rows.start;
        for column in 1..=columns {
            let end_s = begin_s + span_s * column as f64 / columns as f64;
            let rest = &self.times_s[from..rows.end];
            let to = match column == columns {
                true => rows.end,
                false => from + rest.partition_point(|&time_s| time_s < end_s),
            };
            if from < to {
                match pyramid.extremes(&self.values, from..to) {
                    None => shown.push(None),
                    Some([first, second]) if first == second => shown.push(Some(first)),
                    Some(both) => shown.extend(both.map(Some)),
                }
            }
            from = to;
        }
        self.with_pauses(shown)
    }

    fn all(&self, rows: Range<usize>) -> Vec<Option<usize>> {
        let present = |row| (!self.values.value(row).is_nan()).then_some(row);
        self.with_pauses(rows.map(present).collect())
    }

    /// Inserts a gap between consecutive rows with a pause of the log between them.
    fn with_pauses(&self, shown: Vec<Option<usize>>) -> Vec<Option<usize>> {
        let gap_s = self.gap_s();
        let mut with_pauses: Vec<Option<usize>> = Vec::with_capacity(shown.len());
        for row in shown {
            if let (Some(Some(before)), Some(here)) = (with_pauses.last().copied(), row) {
                let between_s = &self.times_s[before..=here];
                let is_far = between_s[between_s.len() - 1] - between_s[0] > gap_s;
                if is_far && between_s.windows(2).any(|pair| pair[1] - pair[0] > gap_s) {
                    with_pauses.push(None);
                }
            }
            with_pauses.push(row);
        }
        with_pauses
    }
}

impl<'a> Trace<'a> {
    /// Returns the signal `name` in its own unit; `None` if it is not recorded.
    pub fn of(recording: &'a Recording, name: &str) -> Option<Self> {
        let values = recording.signal(name)?.values_or_nan();
        Self::on(recording, name, values.into())
    }

    /// Returns the signal `name` in `unit`; `None` if it is not recorded or has another quantity.
    pub fn of_in(recording: &'a Recording, name: &str, unit: Unit) -> Option<Self> {
        let values = recording.signal(name)?.values_in(unit).ok()?;
        Self::on(recording, name, values.into())
    }

    /// Returns values at the instants of the signal `name`; `None` if it is not recorded.
    ///
    /// # Panics
    /// If the number of values is not that of the instants.
    pub fn on(recording: &'a Recording, name: &str, values: Cow<'a, [f64]>) -> Option<Self> {
        let times_s = recording.time_base_of(name)?.times_s();
        // A single sample is drawn for a second.
        let step_s = median_step_s(times_s).unwrap_or(1.0);
        Some(Self::new(times_s, values, step_s))
    }

    /// Returns the sum with another series of the same instants; `None` if the number of samples differs.
    pub fn plus(&self, other: &Trace<'_>) -> Option<Self> {
        let pairs = || self.values.iter().zip(other.values.iter());
        (self.values.len() == other.values.len()).then(|| Self {
            values: pairs().map(|(a, b)| a + b).collect(),
            ..self.clone()
        })
    }

    /// Multiplies every value by `factor`.
    pub fn times(mut self, factor: f64) -> Self {
        let values = self.values.to_mut();
        values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    /// Returns the series at the instants at which it was sampled, if it has a lower rate than its rows.
    pub fn at_own_rows(&self) -> Cow<'_, Self> {
        match OwnSamples::of(&self.times_s, &self.values) {
            None => Cow::Borrowed(self),
            Some(own) => Cow::Owned(Self {
                step_s: median_step_s(&own.times_s).unwrap_or(self.step_s),
                times_s: own.times_s.into(),
                values: own.values.into(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn uniform(values: &[f64], step_s: f64) -> Trace<'static> {
        let times_s: Vec<f64> = (0..values.len()).map(|row| row as f64 * step_s).collect();
        Trace::new(times_s, values.to_vec().into(), step_s)
    }

    proptest! {
        /// Goal: a peak of a single sample is visible in a log of any length. Method: in each column the shown samples
        /// have the minimum and the maximum of all samples.
        #[test]
        fn decimation_keeps_the_extremes_of_every_column(
            values in prop::collection::vec(prop_oneof![Just(0.0), -9.0..9.0, Just(f64::NAN)], 1..2000),
            columns in 1_usize..80,
        ) {
            let trace = uniform(&values, 0.01);
            let shown = trace.decimated(0..values.len(), columns);
            let shown: Vec<usize> = shown.into_iter().flatten().collect();
            prop_assert!(shown.len() <= 2 * columns);
            prop_assert!(shown.is_sorted_by(|one, next| one < next));
            prop_assert!(shown.iter().all(|&row| !values[row].is_nan()));
            if values.len() <= 2 * columns {
                return Ok(());
            }
            let span_s = trace.times_s()[values.len() - 1];
            let edge_s = |column: usize| span_s * column as f64 / columns as f64;
            let extent = |rows: &mut dyn Iterator<Item = usize>, column: usize| {
                let is_last = column + 1 == columns;
                rows.filter(|&row| {
                    let time_s = trace.times_s()[row];
                    time_s >= edge_s(column) && (is_last || time_s < edge_s(column + 1))
                })
                .map(|row| values[row])
                .filter(|value| !value.is_nan())
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
            };
            for column in 0..columns {
                let all = extent(&mut (0..values.len()), column);
                prop_assert_eq!(extent(&mut shown.iter().copied(), column), all, "column {}", column);
            }
        }
    }

    #[test]
    fn one_peak_in_a_million_samples_is_shown() {
        let mut values = vec![0.0; 1_000_000];
        values[654_321] = 9.0;
        let shown = uniform(&values, 0.001).decimated(0..values.len(), 400);
        assert!(shown.len() <= 800, "{}", shown.len());
        assert!(shown.contains(&Some(654_321)));
    }

    #[test]
    fn missing_samples_and_pauses_of_the_log_are_gaps() {
        let values: &[f64] = &[1.0, f64::NAN, 2.0, 3.0];
        let trace = Trace::new(vec![0.0, 0.1, 0.2, 5.0], values, 0.1);
        assert_eq!(
            trace.decimated(0..4, 400),
            [Some(0), None, Some(2), None, Some(3)]
        );
    }

    #[test]
    fn a_pause_within_a_column_and_a_column_without_samples_are_gaps() {
        let mut values: Vec<f64> = (0..1000).map(|row| f64::from(row % 7)).collect();
        values[400..700].fill(f64::NAN);
        let times_s: Vec<f64> = (0..1000)
            .map(|row| f64::from(row) * 0.01 + if row > 150 { 0.5 } else { 0.0 })
            .collect();
        let shown = Trace::new(times_s, &values[..], 0.01).decimated(0..1000, 10);
        let gaps = shown.iter().filter(|row| row.is_none()).count();
        assert!(gaps >= 2, "{shown:?}");
        let pause = shown.iter().position(|row| row.is_none()).unwrap();
        let [Some(before), None, Some(after)] = shown[pause - 1..=pause + 1] else {
            panic!("{shown:?}");
        };
        assert!(before <= 150 && after > 150, "{shown:?}");
    }

    #[test]
    fn a_signal_of_a_lower_rate_has_the_step_of_its_own_samples() {
        let values: Vec<f64> = (0..100)
            .map(|row| {
                if row % 5 == 0 {
                    f64::from(row)
                } else {
                    f64::NAN
                }
            })
            .collect();
        let trace = uniform(&values, 0.01);
        let own = trace.at_own_rows();
        assert_eq!(own.times_s().len(), 20);
        assert!((own.step_s() - 0.05).abs() < 1e-12, "{}", own.step_s());
    }
}
