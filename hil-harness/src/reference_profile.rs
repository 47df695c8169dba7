//! Reference of the chamber pressure over time.

use core::fmt;

use recording::{ConversionError, MissingSignal, Quantity, Recording, Unit};

/// Reference over time: holds, steps and ramps, in the order of time.
///
/// ```
/// use hil_harness::ReferenceProfile;
///
/// let profile = ReferenceProfile::starting_at(2.0).hold_ms(500).step_to(3.0).hold_ms(1000).ramp_to(1.0, 200);
/// assert_eq!(profile.at_ns(499_999_999), 2.0);
/// assert_eq!(profile.at_ns(500_000_000), 3.0);
/// assert_eq!(profile.at_ns(1_600_000_000), 2.0);
/// assert_eq!(profile.end_ns(), 1_700_000_000);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceProfile {
    /// Knots in order of time; two at one instant are a step, and the later one counts.
    knots: Vec<Knot>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    time_ns: u64,
    reference_bar: f64,
}

/// Change of the reference: a step, or a ramp if it has a duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Begin of the change (ns).
    pub time_ns: u64,
    /// Reference at its end (bar gauge).
    pub to_bar: f64,
    /// Duration of the change (ns).
    pub within_ns: u64,
}

/// Lowest and highest reference (bar gauge): vacuum, and the largest supply pressure that a controller can be set to.
pub const REFERENCE_RANGE_BAR: [f64; 2] = [-1.0, 15.0];

const NS_PER_MS: u64 = 1_000_000;

impl ReferenceProfile {
    /// Creates a profile that begins at `reference_bar` (bar gauge).
    pub fn starting_at(reference_bar: f64) -> Self {
        Self {
            knots: vec![Knot {
                time_ns: 0,
                reference_bar,
            }],
        }
    }

    /// Appends a constant reference for `duration_ms` (ms).
    #[must_use]
    pub fn hold_ms(self, duration_ms: u32) -> Self {
        let reference_bar = self.last().reference_bar;
        self.ramp_to(reference_bar, duration_ms)
    }

    /// Appends a step to `reference_bar` (bar gauge).
    #[must_use]
    pub fn step_to(self, reference_bar: f64) -> Self {
        self.ramp_to(reference_bar, 0)
    }

    /// Appends a linear ramp to `reference_bar` (bar gauge) within `duration_ms` (ms).
    #[must_use]
    pub fn ramp_to(mut self, reference_bar: f64, duration_ms: u32) -> Self {
        let time_ns = self.last().time_ns + u64::from(duration_ms) * NS_PER_MS;
        self.knots.push(Knot {
            time_ns,
            reference_bar,
        });
        self
    }

    /// Creates a profile from the signal `p_ref` of a recording, such as a CSV with the columns `time_s` and
    /// `p_ref_bar_gauge`. Each value is constant until the next, and the first instant becomes time 0.
    ///
    /// # Errors
    /// Returns an error if there is no such signal, a value is missing (nothing is filled in), or a value is out of
    /// range.
    pub fn from_recording(recording: &Recording) -> Result<Self, ProfileError> {
        let signal = recording.require("p_ref", Quantity::Pressure)?;
        let values = signal.values_in(Unit::BarGauge)?;
        let Some(times) = recording.time_base(signal.time_base()) else {
            return Ok(Self::starting_at(0.0));
        };
        let mut profile = Self {
            knots: Vec::with_capacity(2 * values.len()),
        };
        for (index, (&time_s, &reference_bar)) in times.times_s().iter().zip(&values).enumerate() {
            if reference_bar.is_nan() {
                return Err(ProfileError::Missing { index, time_s });
            }
            let time_ns = ((time_s - times.start_s()) * 1e9).round() as u64;
            if let Some(&before) = profile.knots.last() {
                profile.knots.push(Knot { time_ns, ..before });
            }
            profile.knots.push(Knot {
                time_ns,
                reference_bar,
            });
        }
        profile.check()?;
        Ok(profile)
    }

    /// Creates a profile from its reference at time 0 (bar gauge), its changes in the order of time, and its end (ns).
    ///
    /// # Errors
    /// Returns an error if a change begins before the previous one has ended, or ends after the end, or if a reference
    /// is out of range.
    pub fn from_changes(
        start_bar: f64,
        changes: &[Change],
        end_ns: u64,
    ) -> Result<Self, ProfileError> {
        let mut profile = Self::starting_at(start_bar);
        let ends = changes.iter().map(|change| {
            let end_ns = change.time_ns.saturating_add(change.within_ns);
            (change.time_ns, end_ns, Some(change.to_bar))
        });
        for (time_ns, until_ns, to_bar) in ends.chain([(end_ns, end_ns, None)]) {
            let before = profile.last();
            if time_ns < before.time_ns {
                return Err(ProfileError::Order {
                    time_s: time_ns as f64 / 1e9,
                    before_s: before.time_ns as f64 / 1e9,
                });
            }
            profile.knots.push(Knot { time_ns, ..before });
            if let Some(reference_bar) = to_bar {
                profile.knots.push(Knot {
                    time_ns: until_ns,
                    reference_bar,
                });
            }
        }
        profile.check()?;
        Ok(profile)
    }

    /// Returns the changes after time 0, in the order of time; see [`Self::from_changes`].
    pub fn changes(&self) -> Vec<Change> {
        self.knots
            .windows(2)
            .filter(|pair| pair[0].reference_bar != pair[1].reference_bar)
            .map(|pair| Change {
                time_ns: pair[0].time_ns,
                to_bar: pair[1].reference_bar,
                within_ns: pair[1].time_ns - pair[0].time_ns,
            })
            .collect()
    }

    /// Returns the reference before the first change (bar gauge).
    pub fn start_bar(&self) -> f64 {
        self.knots.first().map_or(0.0, |knot| knot.reference_bar)
    }

    /// Returns the reference at an instant (bar gauge); the last one is valid forever.
    pub fn at_ns(&self, time_ns: u64) -> f64 {
        let after = self.knots.partition_point(|knot| knot.time_ns <= time_ns);
        let Some(&from) = after.checked_sub(1).and_then(|index| self.knots.get(index)) else {
            return self.knots.first().map_or(0.0, |knot| knot.reference_bar);
        };
        match self.knots.get(after) {
            None => from.reference_bar,
            Some(to) => {
                let share = (time_ns - from.time_ns) as f64 / (to.time_ns - from.time_ns) as f64;
                from.reference_bar + share * (to.reference_bar - from.reference_bar)
            }
        }
    }

    /// Returns the end of the profile (ns).
    pub fn end_ns(&self) -> u64 {
        self.last().time_ns
    }

    /// Checks that every reference is a pressure within [`REFERENCE_RANGE_BAR`].
    ///
    /// # Errors
    /// Returns the first reference that is not.
    pub fn check(&self) -> Result<(), ProfileError> {
        let [low, high] = REFERENCE_RANGE_BAR;
        match self
            .knots
            .iter()
            .find(|knot| !(low..=high).contains(&knot.reference_bar))
        {
            None => Ok(()),
            Some(knot) => Err(ProfileError::OutOfRange {
                time_s: knot.time_ns as f64 / 1e9,
                reference_bar: knot.reference_bar,
            }),
        }
    }

    fn last(&self) -> Knot {
        self.knots.last().copied().unwrap_or(Knot {
            time_ns: 0,
            reference_bar: 0.0,
        })
    }
}

impl fmt::Display for ReferenceProfile {
    /// Writes `0 s: 2 bar, 0.5 s: step to 3 bar, 1.7 s: ramp to 1 bar`, in gauge.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0 s: {} bar", self.start_bar())?;
        for pair in self.knots.windows(2) {
            if pair[0].reference_bar == pair[1].reference_bar {
                continue;
            }
            let time_s = pair[1].time_ns as f64 / 1e9;
            let way = if pair[0].time_ns == pair[1].time_ns {
                "step"
            } else {
                "ramp"
            };
            write!(f, ", {time_s} s: {way} to {} bar", pair[1].reference_bar)?;
        }
        Ok(())
    }
}

/// Reason why data is no reference profile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// The recording has no `p_ref`, or it is no pressure.
    #[error(transparent)]
    NoReference(#[from] MissingSignal),
    /// `p_ref` is not in a gauge unit.
    #[error("p_ref: {0}; write the reference as gauge pressure, `p_ref_bar_gauge`")]
    Unit(#[from] ConversionError),
    /// A reference is missing.
    #[error(
        "p_ref has no value at {time_s} s (row {index}, from 0): a reference is never guessed, write one"
    )]
    Missing {
        /// Index of the sample, from 0.
        index: usize,
        /// Time of the sample (s).
        time_s: f64,
    },
    /// The changes are not in the order of time.
    #[error(
        "what comes at {time_s} s begins before {before_s} s, where the change before it ends; bring the changes and the \
         end into the order of time"
    )]
    Order {
        /// Begin of the change (s).
        time_s: f64,
        /// End of the previous change (s).
        before_s: f64,
    },
    /// The reference is no possible pressure of a chamber.
    #[error(
        "reference {reference_bar} bar gauge at {time_s} s is out of range: allowed {} to {} bar gauge",
        REFERENCE_RANGE_BAR[0], REFERENCE_RANGE_BAR[1]
    )]
    OutOfRange {
        /// Time of the reference (s).
        time_s: f64,
        /// Value of the reference (bar gauge).
        reference_bar: f64,
    },
}

#[cfg(test)]
mod tests {
    use recording::{Provenance, TimeBase};

    use super::*;

    fn recorded(times_s: Vec<f64>, values: Vec<f64>, unit: Unit) -> Recording {
        let mut recording = Recording::new(Provenance::from_source("R.csv"));
        let base = recording.add_time_base(TimeBase::new(times_s).unwrap());
        recording.add_signal("p_ref", unit, base, values).unwrap();
        recording
    }

    #[test]
    fn a_recorded_reference_holds_until_the_next_row_and_starts_at_time_0() {
        let log = recorded(
            vec![5.0, 5.5, 7.0],
            vec![200.0, 300.0, 100.0],
            Unit::KilopascalGauge,
        );
        let profile = ReferenceProfile::from_recording(&log).unwrap();
        for (time_ns, expected) in [
            (0, 2.0),
            (499_999_999, 2.0),
            (500_000_000, 3.0),
            (1_999_999_999, 3.0),
            (2_000_000_000, 1.0),
            (u64::MAX, 1.0),
        ] {
            assert_eq!(profile.at_ns(time_ns), expected, "{time_ns} ns");
        }
        assert_eq!(profile.end_ns(), 2_000_000_000);
    }

    #[test]
    fn a_recorded_reference_that_is_absent_missing_absolute_or_impossible_is_refused_with_what_to_do()
     {
        let cases = [
            (
                recorded(vec![0.0, 0.5], vec![2.0, f64::NAN], Unit::BarGauge),
                "no value at 0.5 s",
            ),
            (
                recorded(vec![0.0, 0.5], vec![2.0, 3.0], Unit::BarAbsolute),
                "p_ref_bar_gauge",
            ),
            (
                recorded(vec![0.0, 0.5], vec![2.0, 300.0], Unit::BarGauge),
                "300 bar gauge at 0.5 s",
            ),
            (
                recorded(vec![0.0, 0.5], vec![2.0, 3.0], Unit::Volt),
                "check its unit",
            ),
            (
                Recording::new(Provenance::from_source("R.csv")),
                "R.csv has no signal \"p_ref\"",
            ),
        ];
        for (log, expected) in cases {
            let error = ReferenceProfile::from_recording(&log)
                .unwrap_err()
                .to_string();
            assert!(
                error.contains(expected),
                "{error:?} does not say {expected:?}"
            );
        }
    }

    #[test]
    fn a_profile_and_its_changes_are_the_same() {
        let profile = ReferenceProfile::starting_at(2.0)
            .hold_ms(500)
            .step_to(3.0)
            .hold_ms(1000)
            .ramp_to(1.0, 200)
            .hold_ms(300);
        let changes = profile.changes();
        assert_eq!(changes.len(), 2);
        let again = ReferenceProfile::from_changes(profile.start_bar(), &changes, profile.end_ns())
            .unwrap();
        for time_ms in 0..2500 {
            let time_ns = time_ms * NS_PER_MS;
            assert_eq!(again.at_ns(time_ns), profile.at_ns(time_ns), "{time_ms} ms");
        }
        assert_eq!(again.end_ns(), profile.end_ns());
        assert_eq!(again.changes(), changes);
    }

    #[test]
    fn changes_out_of_order_or_range_are_refused() {
        let change = |time_ns, to_bar, within_ns| Change {
            time_ns,
            to_bar,
            within_ns,
        };
        let of = |changes: &[Change], end_ns| {
            ReferenceProfile::from_changes(0.0, changes, end_ns)
                .unwrap_err()
                .to_string()
        };
        assert!(of(&[change(2, 1.0, 0), change(1, 2.0, 0)], 9).contains("order of time"));
        assert!(of(&[change(0, 1.0, 5), change(4, 2.0, 0)], 9).contains("order of time"));
        assert!(of(&[change(0, 1.0, 5)], 4).contains("order of time"));
        assert!(of(&[change(0, 16.0, 0)], 4).contains("out of range"));
    }

    #[test]
    fn a_profile_prints_its_steps_and_ramps_in_order() {
        let profile = ReferenceProfile::starting_at(2.0)
            .hold_ms(500)
            .step_to(3.0)
            .hold_ms(1000)
            .ramp_to(1.0, 200);
        assert_eq!(
            profile.to_string(),
            "0 s: 2 bar, 0.5 s: step to 3 bar, 1.7 s: ramp to 1 bar"
        );
    }

    #[test]
    fn a_reference_out_of_range_is_refused_and_the_ends_are_not() {
        for (reference_bar, expected) in
            [(-1.0, true), (15.0, true), (15.1, false), (f64::NAN, false)]
        {
            assert_eq!(
                ReferenceProfile::starting_at(reference_bar).check().is_ok(),
                expected,
                "{reference_bar}"
            );
        }
    }
}
