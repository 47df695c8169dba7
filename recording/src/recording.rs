use std::sync::Arc;

use crate::name::{NameError, check_name, is_time_column};
use crate::signal::quantity_of;
use crate::{OutOfBounds, Provenance, Quantity, Signal, SkippedRow, TimeBase, Unit};

/// Measured or simulated data: named signals with unit and time base, and their provenance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    provenance: Provenance,
    time_bases: Vec<TimeBase>,
    pub(crate) signals: Vec<Signal>,
    left_out: Vec<LeftOut>,
    out_of_bounds: Vec<OutOfBounds>,
    needs: Vec<(String, f64)>,
    skipped_rows: Vec<SkippedRow>,
}

/// Channel of the source that is no signal of the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name in the source.
    pub name: String,
    /// Reason why it is no signal, and the next step.
    pub reason: String,
}

/// Identifier of one time base of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TimeBaseId(usize);

impl Recording {
    /// Creates a recording without signals.
    pub fn new(provenance: Provenance) -> Self {
        Self {
            provenance,
            ..Self::default()
        }
    }

    /// Adds a time base and returns its id, which is valid for this recording only.
    pub fn add_time_base(&mut self, time_base: TimeBase) -> TimeBaseId {
        self.time_bases.push(time_base);
        TimeBaseId(self.time_bases.len() - 1)
    }

    /// Adds a signal with `samples` in `unit`; NaN marks a missing sample.
    ///
    /// # Errors
    /// Returns an [`AddSignalError`] if the name is taken or invalid, the number of samples is not that of the time
    /// base, or a sample is infinite.
    pub fn add_signal(
        &mut self,
        name: impl Into<String>,
        unit: Unit,
        time_base: TimeBaseId,
        samples: Vec<f64>,
    ) -> Result<&Signal, AddSignalError> {
        self.add_shared_signal(name, unit, time_base, Arc::new(samples))
    }

    /// Adds a signal whose samples are shared with another owner: they are not copied.
    ///
    /// # Errors
    /// Returns the same errors as [`Recording::add_signal`].
    pub fn add_shared_signal(
        &mut self,
        name: impl Into<String>,
        unit: Unit,
        time_base: TimeBaseId,
        samples: Arc<Vec<f64>>,
    ) -> Result<&Signal, AddSignalError> {
        let name = name.into();
        check_name(&name).map_err(|problem| AddSignalError::Name {
            name: name.clone(),
            problem,
        })?;
        if is_time_column(&name, unit) {
            return Err(AddSignalError::TimeIsNoSignal { name });
        }
        if self.signal(&name).is_some() {
            return Err(AddSignalError::NameTaken { name });
        }
        let expected = self
            .time_bases
            .get(time_base.0)
            .ok_or_else(|| AddSignalError::UnknownTimeBase { name: name.clone() })?
            .len();
        if samples.len() != expected {
            return Err(AddSignalError::Length {
                name,
                expected,
                found: samples.len(),
            });
        }
        if let Some(index) = samples.iter().position(|sample| sample.is_infinite()) {
            return Err(AddSignalError::Infinite { name, index });
        }
        let last = self.signals.len();
        self.signals.push(Signal {
            name,
            unit,
            time_base,
            samples,
        });
        Ok(&self.signals[last])
    }

    /// Returns the recording in which the signal `from` has the name `to`; a signal of that name is left out. `None` if there is no signal
    /// `from`.
    pub fn renamed(&self, from: &str, to: &str) -> Option<Self> {
        self.signal(from)?;
        let mut renamed = self.clone();
        if self.signal(to).is_some() {
            renamed.leave_out(to, format!("`{from}` takes its place"));
            renamed.signals.retain(|signal| signal.name != to);
        }
        for signal in renamed
            .signals
            .iter_mut()
            .filter(|signal| signal.name == from)
        {
            to.clone_into(&mut signal.name);
        }
        for (name, _) in renamed.needs.iter_mut().filter(|(name, _)| name == from) {
            to.clone_into(name);
        }
        Some(renamed)
    }

    /// Notes that the source has `name`, which is no signal here because of `reason`; the reason is reported when
    /// `name` is required.
    pub fn leave_out(&mut self, name: impl Into<String>, reason: impl Into<String>) {
        self.left_out.push(LeftOut {
            name: name.into(),
            reason: reason.into(),
        });
    }

    /// Returns the channels of the source that are no signals, in the order of the source.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// Adds a row of the source that the reader skipped.
    pub fn add_skipped_row(&mut self, row: SkippedRow) {
        self.skipped_rows.push(row);
    }

    /// Returns the rows of the source that the reader skipped, in order.
    pub fn skipped_rows(&self) -> &[SkippedRow] {
        &self.skipped_rows
    }

    /// Sets the tolerated model error of the signal `name` (rms, in the unit of the signal).
    pub fn set_need(&mut self, name: impl Into<String>, need: f64) {
        self.needs.push((name.into(), need));
    }

    /// Returns the tolerated model error of the signal `name` (rms, in the unit of the signal); 0 if it was not set.
    pub fn need(&self, name: &str) -> f64 {
        let needs = self.needs.iter().filter(|(signal, _)| signal == name);
        needs.map(|&(_, need)| need).fold(0.0, f64::max)
    }

    pub(crate) fn add_out_of_bounds(&mut self, cells: OutOfBounds) {
        self.out_of_bounds.push(cells);
    }

    /// Returns the cells of the source with values outside the hard bounds of their quantity, signal by signal: they
    /// are missing here.
    pub fn out_of_bounds(&self) -> &[OutOfBounds] {
        &self.out_of_bounds
    }

    /// Returns whether the source has `name`, as a signal or left out.
    pub fn mentions(&self, name: &str) -> bool {
        self.signal(name).is_some() || self.reason_left_out(name).is_some()
    }

    /// Returns the reason why `name` was left out, if it was, and if no other channel became the signal of this name.
    pub fn reason_left_out(&self, name: &str) -> Option<&str> {
        if self.signal(name).is_some() {
            return None;
        }
        self.left_out
            .iter()
            .find(|left_out| left_out.name == name)
            .map(|left_out| left_out.reason.as_str())
    }

    /// Returns the provenance of the recording.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// Returns the provenance of the recording for changes, such as a further note.
    pub fn provenance_mut(&mut self) -> &mut Provenance {
        &mut self.provenance
    }

    /// Returns all signals in the order in which they were added.
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// Returns all time bases with their ids.
    pub fn time_bases(&self) -> impl Iterator<Item = (TimeBaseId, &TimeBase)> {
        self.time_bases
            .iter()
            .enumerate()
            .map(|(index, base)| (TimeBaseId(index), base))
    }

    /// Returns the time base with this id; `None` if the id belongs to another recording.
    pub fn time_base(&self, id: TimeBaseId) -> Option<&TimeBase> {
        self.time_bases.get(id.0)
    }

    /// Returns the time base of the signal `name`.
    pub fn time_base_of(&self, name: &str) -> Option<&TimeBase> {
        self.signal(name)
            .and_then(|signal| self.time_base(signal.time_base()))
    }

    /// Returns the signal `name`, if it exists.
    pub fn signal(&self, name: &str) -> Option<&Signal> {
        self.signals.iter().find(|signal| signal.name() == name)
    }

    /// Returns the signal `name`, which must have this `quantity`.
    ///
    /// # Errors
    /// Returns a [`MissingSignal`] with the existing signals, or with the quantity of the signal.
    pub fn require(&self, name: &str, quantity: Quantity) -> Result<&Signal, MissingSignal> {
        let source = || self.provenance.source.clone();
        let absent = || match self.reason_left_out(name) {
            Some(reason) => MissingSignal::LeftOut {
                source_name: source(),
                name: name.to_owned(),
                reason: reason.to_owned(),
            },
            None => MissingSignal::Absent {
                source_name: source(),
                name: name.to_owned(),
                quantity,
                present: self
                    .signals
                    .iter()
                    .map(|signal| signal.name().to_owned())
                    .collect(),
            },
        };
        let signal = self.signal(name).ok_or_else(absent)?;
        if signal.quantity() != quantity {
            return Err(MissingSignal::OtherQuantity {
                source_name: source(),
                name: name.to_owned(),
                quantity,
                unit: signal.unit(),
            });
        }
        Ok(signal)
    }
}

/// Reason why a signal cannot be added to a recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AddSignalError {
    /// The name is empty, too long or not printable.
    #[error("{name:?} cannot name a signal: {problem}")]
    Name {
        /// The refused name.
        name: String,
        /// Problem of the name.
        problem: NameError,
    },
    /// A column with this name and unit would be read back as the time.
    #[error("{name:?} with a unit of time is the time base: choose another name")]
    TimeIsNoSignal {
        /// The refused name.
        name: String,
    },
    /// Another signal has this name.
    #[error("there is a signal {name:?} already: names are unique within a recording")]
    NameTaken {
        /// The refused name.
        name: String,
    },
    /// The id belongs to another recording.
    #[error("the time base of {name:?} is not part of this recording: add it first")]
    UnknownTimeBase {
        /// Name of the signal.
        name: String,
    },
    /// The numbers of samples and of instants differ.
    #[error(
        "{name:?} has {found} samples, its time base {expected}: give one per instant, NaN where missing"
    )]
    Length {
        /// Name of the signal.
        name: String,
        /// Number of instants.
        expected: usize,
        /// Number of samples.
        found: usize,
    },
    /// A sample is infinite.
    #[error("sample {index} of {name:?} is infinite: samples are finite, or NaN where missing")]
    Infinite {
        /// Name of the signal.
        name: String,
        /// Index of the sample, from 0.
        index: usize,
    },
}

/// Returns names as part of a sentence.
fn listed(names: &[String]) -> String {
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}

/// Error: a required signal is missing, or has another quantity.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MissingSignal {
    /// No signal has this name.
    #[error(
        "{source_name} has no signal {name:?} ({quantity}); it has {}: log it, or map a column to this name",
        listed(present)
    )]
    Absent {
        /// Source of the recording.
        source_name: String,
        /// Wanted name.
        name: String,
        /// Wanted quantity.
        quantity: Quantity,
        /// Names of the existing signals.
        present: Vec<String>,
    },
    /// The source has the channel, but it could not be read as a signal.
    #[error("{name:?} in {source_name} was left out: {reason}")]
    LeftOut {
        /// Source of the recording.
        source_name: String,
        /// Wanted name.
        name: String,
        /// Reason, and the next step.
        reason: String,
    },
    /// The signal has another quantity.
    #[error(
        "{name:?} in {source_name} is logged in {unit}, a {}; wanted is a {quantity}: check its unit",
        quantity_of(name, *unit)
    )]
    OtherQuantity {
        /// Source of the recording.
        source_name: String,
        /// Name of the signal.
        name: String,
        /// Wanted quantity.
        quantity: Quantity,
        /// Logged unit.
        unit: Unit,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_samples() -> (Recording, TimeBaseId) {
        let mut recording = Recording::new(Provenance::from_source("bench"));
        let time_base = recording.add_time_base(TimeBase::uniform(0.0, 0.01, 2).unwrap());
        (recording, time_base)
    }

    #[test]
    fn a_missing_sample_stays_missing_and_keeps_its_place() {
        let (mut recording, time_base) = two_samples();
        let signal = recording
            .add_signal("p_ch", Unit::BarGauge, time_base, vec![f64::NAN, 2.0])
            .unwrap();
        assert_eq!(
            (signal.get(0), signal.get(1), signal.get(2)),
            (None, Some(2.0), None)
        );
        assert_eq!(signal.iter().collect::<Vec<_>>(), [None, Some(2.0)]);
        assert_eq!(signal.missing_count(), 1);
        let converted = signal.values_in(Unit::KilopascalGauge).unwrap();
        assert!(converted[0].is_nan());
        assert_eq!(converted[1], 200.0);
        let absolute = signal
            .values_at_ambient(Unit::BarAbsolute, 100_000.0)
            .unwrap();
        assert_eq!(absolute[1], 3.0);
    }

    #[test]
    fn signals_that_would_break_the_recording_are_refused() {
        let (mut recording, time_base) = two_samples();
        let (_, foreign) = {
            let (mut other, _) = two_samples();
            let second = other.add_time_base(TimeBase::uniform(0.0, 1.0, 2).unwrap());
            (other, second)
        };
        recording
            .add_signal("p_ch", Unit::BarGauge, time_base, vec![0.0, 1.0])
            .unwrap();
        let mut refusal = |name: &str, unit, base, samples: &[f64]| {
            recording
                .add_signal(name, unit, base, samples.to_vec())
                .unwrap_err()
        };
        let (volt, fine) = (Unit::Volt, [0.0, 1.0]);
        assert!(matches!(
            refusal("p_ch", volt, time_base, &fine),
            AddSignalError::NameTaken { .. }
        ));
        assert!(matches!(
            refusal("", volt, time_base, &fine),
            AddSignalError::Name { .. }
        ));
        assert!(matches!(
            refusal("u", volt, foreign, &fine),
            AddSignalError::UnknownTimeBase { .. }
        ));
        assert!(matches!(
            refusal("time", Unit::Second, time_base, &fine),
            AddSignalError::TimeIsNoSignal { .. }
        ));
        assert!(matches!(
            refusal("u", volt, time_base, &[1.0]),
            AddSignalError::Length {
                expected: 2,
                found: 1,
                ..
            }
        ));
        let infinite = [0.0, f64::INFINITY];
        assert!(matches!(
            refusal("u", volt, time_base, &infinite),
            AddSignalError::Infinite { index: 1, .. }
        ));
    }

    #[test]
    fn what_was_left_out_is_reported_to_whoever_asks_for_it() {
        let (mut recording, _) = two_samples();
        recording.leave_out("p_ch", "found \"bar\", expected gauge or absolute");
        assert!(recording.mentions("p_ch") && !recording.mentions("u"));
        let error = recording
            .require("p_ch", Quantity::Pressure)
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            "\"p_ch\" in bench was left out: found \"bar\", expected gauge or absolute"
        );
    }

    #[test]
    fn a_required_signal_must_be_there_and_be_the_quantity() {
        let (mut recording, time_base) = two_samples();
        recording
            .add_signal("duty_fill", Unit::Percent, time_base, vec![0.0, 50.0])
            .unwrap();
        recording
            .add_signal("u", Unit::Percent, time_base, vec![0.0, -50.0])
            .unwrap();
        assert!(recording.require("duty_fill", Quantity::DutyCycle).is_ok());
        assert!(recording.require("u", Quantity::Ratio).is_ok());
        let absent = recording
            .require("p_ch", Quantity::Pressure)
            .unwrap_err()
            .to_string();
        assert!(
            absent.contains("p_ch") && absent.contains("duty_fill"),
            "{absent}"
        );
        let other = recording
            .require("u", Quantity::DutyCycle)
            .unwrap_err()
            .to_string();
        assert!(
            other.contains("ratio") && other.contains("duty cycle"),
            "{other}"
        );
    }
}
