//! Signals of several rates on one time base.

use std::borrow::Cow;
use std::sync::Arc;

use crate::{Recording, Signal, TimeBase, TimeBaseId};

/// Difference over the smallest median step below which instants are equal: groups of one logger differ in the last
/// bits.
const SAME_IN_MEDIAN_STEPS: f64 = 1e-6;
/// Share of the rows with a value up to which a signal counts as sampled at these rows only ...
const SAMPLED_AT_EVERY_ROW: f64 = 2.0 / 3.0;
/// ... if at least this share of the values is followed by a row without one, since otherwise its sensor failed for a
/// while, ...
const INTERLEAVED: f64 = 0.25;
/// ... and if it has at least this number of values.
const FEWEST: usize = 10;

impl Signal {
    /// Returns the rows with a value if the signal was sampled at these rows only, as a slow signal of a log with
    /// several rates is: at most two thirds of the rows have a value, in turn with the others. `None` if it was sampled
    /// at every row, so that a row without a value is a missing sample.
    pub fn own_rows(&self) -> Option<Vec<usize>> {
        own_rows(&self.samples)
    }
}

/// Returns the same as [`Signal::own_rows`], for samples with NaN where missing.
pub fn own_rows(samples: &[f64]) -> Option<Vec<usize>> {
    let is_present = |sample: &f64| !sample.is_nan();
    let mut cells = OwnRate::default();
    samples
        .iter()
        .for_each(|sample| cells.add(is_present(sample)));
    cells.is_own().then(|| {
        let samples = samples.iter().enumerate();
        let present = samples.filter(|(_, sample)| is_present(sample));
        present.map(|(row, _)| row).collect()
    })
}

/// Samples of a signal that was sampled at some rows only.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnSamples {
    /// Rows of the samples, in order.
    pub rows: Vec<usize>,
    /// Instants of the samples (s).
    pub times_s: Vec<f64>,
    /// Values of the samples.
    pub values: Vec<f64>,
}

impl OwnSamples {
    /// Returns the samples of a signal with a value or NaN at each of the instants `times_s`; `None` if it was sampled
    /// at every row.
    pub fn of(times_s: &[f64], samples: &[f64]) -> Option<Self> {
        let rows = own_rows(samples)?;
        let of_rows = |all: &[f64]| rows.iter().map(|&row| all[row]).collect();
        Some(Self {
            times_s: of_rows(times_s),
            values: of_rows(samples),
            rows,
        })
    }
}

/// Counts of the cells of a signal, which show whether it was sampled at some rows only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OwnRate {
    rows: usize,
    present: usize,
    /// Number of values with a row without one behind them.
    ends: usize,
    is_last_present: bool,
}

impl OwnRate {
    /// Counts the next cell, which has a value or not.
    pub(crate) fn add(&mut self, is_present: bool) {
        self.rows += 1;
        self.present += usize::from(is_present);
        self.ends += usize::from(self.is_last_present && !is_present);
        self.is_last_present = is_present;
    }

    /// Returns whether the signal was sampled at the rows with a value only.
    pub(crate) fn is_own(self) -> bool {
        let present = self.present as f64;
        self.present >= FEWEST
            && present <= SAMPLED_AT_EVERY_ROW * self.rows as f64
            && self.ends as f64 >= INTERLEAVED * present
    }
}

impl Recording {
    /// Returns the recording with the signals for which `is_meant` returns true on one time base, which has the
    /// instants of all of them. A signal has a value at its own instants only: nothing is interpolated or held. Other
    /// signals keep their time bases. Borrowed if the signals share a time base already.
    pub fn united(&self, is_meant: impl Fn(&str) -> bool) -> Cow<'_, Self> {
        let is_meant = |signal: &Signal| is_meant(signal.name());
        let mut ids: Vec<TimeBaseId> = Vec::new();
        for signal in self.signals().iter().filter(|signal| is_meant(signal)) {
            if !ids.contains(&signal.time_base()) {
                ids.push(signal.time_base());
            }
        }
        let bases: Vec<&TimeBase> = ids.iter().filter_map(|&id| self.time_base(id)).collect();
        if bases.len() < 2 {
            return Cow::Borrowed(self);
        }
        let all = all_instants(&bases);
        let Ok(base) = TimeBase::new(all) else {
            return Cow::Borrowed(self);
        };
        let rows_of: Vec<Vec<usize>> = bases.iter().map(|own| own.rows_in(&base)).collect();
        let mut united = self.clone();
        let count = base.len();
        let id = united.add_time_base(base);
        for signal in united.signals.iter_mut().filter(|signal| is_meant(signal)) {
            let Some(place) = ids.iter().position(|&id| id == signal.time_base) else {
                continue;
            };
            let mut samples = vec![f64::NAN; count];
            for (&row, &sample) in rows_of[place].iter().zip(signal.samples.iter()) {
                samples[row] = sample;
            }
            signal.samples = Arc::new(samples);
            signal.time_base = id;
        }
        Cow::Owned(united)
    }
}

/// Returns the instants of `bases` in order (s), equal ones once.
fn all_instants(bases: &[&TimeBase]) -> Vec<f64> {
    let mut all: Vec<f64> = bases
        .iter()
        .flat_map(|base| base.times_s())
        .copied()
        .collect();
    all.sort_by(f64::total_cmp);
    let steps_s = bases
        .iter()
        .filter_map(|base| base.sampling().median_step_s);
    let same_s = SAME_IN_MEDIAN_STEPS * steps_s.fold(f64::INFINITY, f64::min);
    all.dedup_by(|later_s, kept_s| *later_s - *kept_s <= same_s);
    all
}

impl TimeBase {
    /// Returns the row of each instant in `united`, a time base that [`Recording::united`] made of this one and others:
    /// the instant itself, or an equal one before it.
    pub fn rows_in(&self, united: &TimeBase) -> Vec<usize> {
        let mut next = 0;
        let row = |&time_s: &f64| {
            while united
                .times_s()
                .get(next)
                .is_some_and(|&instant_s| instant_s <= time_s)
            {
                next += 1;
            }
            next.saturating_sub(1)
        };
        self.times_s().iter().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Provenance, Unit};

    fn with_base(recording: &mut Recording, times_s: Vec<f64>, name: &str, values: &[f64]) {
        let id = recording.add_time_base(TimeBase::new(times_s).unwrap());
        let added = recording.add_signal(name, Unit::Volt, id, values.to_vec());
        added.unwrap();
    }

    #[test]
    fn each_signal_keeps_its_samples_at_its_own_instants() {
        let mut log = Recording::new(Provenance::default());
        with_base(&mut log, vec![0.0, 0.1, 0.2], "a", &[1.0, 2.0, 3.0]);
        with_base(&mut log, vec![0.05, 0.1, 0.4], "b", &[4.0, f64::NAN, 6.0]);
        with_base(&mut log, vec![0.3], "other", &[7.0]);
        let united = log.united(|name| name != "other");
        let [a, b, other] = ["a", "b", "other"].map(|name| united.signal(name).unwrap());
        assert_eq!(
            united.time_base_of("a").unwrap().times_s(),
            [0.0, 0.05, 0.1, 0.2, 0.4]
        );
        assert_eq!(a.time_base(), b.time_base());
        let rows = |signal: &Signal| signal.iter().collect::<Vec<_>>();
        assert_eq!(rows(a), [Some(1.0), None, Some(2.0), Some(3.0), None]);
        assert_eq!(rows(b), [None, Some(4.0), None, None, Some(6.0)]);
        assert_eq!(united.time_base_of("other").unwrap().times_s(), [0.3]);
        assert_eq!(rows(other), [Some(7.0)]);
    }

    /// 0.06 s is not exactly 60 times 0.001 s.
    #[test]
    fn instants_that_differ_in_their_last_bits_are_one_row() {
        let mut log = Recording::new(Provenance::default());
        let fast: Vec<f64> = (0..1000).map(|n| f64::from(n) * 0.001).collect();
        let slow: Vec<f64> = (0..100).map(|n| f64::from(n) / 100.0).collect();
        with_base(&mut log, fast.clone(), "fast", &fast);
        with_base(&mut log, slow.clone(), "slow", &slow);
        let united = log.united(|_| true);
        let slow = united.signal("slow").unwrap();
        assert_eq!(slow.len(), 1000);
        let expected: Vec<usize> = (0..100).map(|n| 10 * n).collect();
        assert_eq!(slow.own_rows().unwrap(), expected);
        assert_eq!(united.signal("fast").unwrap().own_rows(), None);
    }

    #[test]
    fn one_time_base_is_left_alone() {
        let mut log = Recording::new(Provenance::default());
        with_base(&mut log, vec![0.0, 0.1], "a", &[1.0, 2.0]);
        with_base(&mut log, vec![0.3], "other", &[7.0]);
        assert!(matches!(log.united(|name| name == "a"), Cow::Borrowed(_)));
    }

    #[test]
    fn missing_samples_are_no_rate_of_their_own() {
        let own = |is_present: &dyn Fn(u32) -> bool| -> Option<Vec<usize>> {
            let value = |row: u32| if is_present(row) { 1.0 } else { f64::NAN };
            own_rows(&(0..40).map(value).collect::<Vec<_>>())
        };
        let every_third: Vec<usize> = (0..40).step_by(3).collect();
        assert_eq!(own(&|row| row.is_multiple_of(3)), Some(every_third));
        // Sampled at every row, with a drop-out now and then; failed in the second half; too short; without any value.
        assert_eq!(own(&|row| !row.is_multiple_of(4)), None);
        assert_eq!(own(&|row| row < 20), None);
        assert_eq!(own(&|row| row.is_multiple_of(8)), None);
        assert_eq!(own(&|_| false), None);
    }
}
