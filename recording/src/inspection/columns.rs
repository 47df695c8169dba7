//! Columns of an inspection, and what each is used for.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::Draft;
use super::glitches::Glitches;
use super::rise::{Trace, rise};
use crate::csv::Excerpt;
use crate::csv::mapping::{CLOCK, Conversion, MappedColumn};
use crate::guess::{self, GuessedUnit, Pair, Question, Subject, TIME};
use crate::name::is_time_column;
use crate::values::ColumnValues;
use crate::{Bounds, LogFormat, PressureReference, Quantity, Unit};

/// Column of the file. One that commands both valves is there twice.
#[derive(Clone)]
pub(super) struct Column {
    /// Position in the file, from 1.
    pub(super) number: u32,
    /// Name in a mapping, and the same in TOML.
    pub(super) key: String,
    pub(super) toml_key: String,
    pub(super) header: String,
    pub(super) unit_in_file: String,
    /// Name and unit that the header states by itself.
    pub(super) own: Option<(String, Unit)>,
    /// Whether the header states them only with the given reference.
    pub(super) needs_reference: bool,
    /// Whether the given mapping explains the column.
    pub(super) is_given: bool,
    /// Reason why it can be no signal.
    pub(super) obstacle: Option<String>,
    pub(super) values: ColumnValues,
    pub(super) thousands: Option<char>,
    /// Whether the column has dates or times of day, which a mapping must state.
    pub(super) is_clock: bool,
    pub(super) times: Arc<Vec<f64>>,
    pub(super) samples: Arc<Vec<f64>>,
    glitches: Option<Glitches>,
    /// Plausible range in the unit of the file, without the glitches.
    pub(super) plausible: Option<RangeInclusive<f64>>,
    /// Time from the first to the last sample (s), if the column has its own instants.
    pub(super) span_s: Option<f64>,
    pub(super) role: Use,
    pub(super) unit: Option<GuessedUnit>,
    pub(super) scale: Option<f64>,
    /// Offset of the given mapping.
    pub(super) offset: Option<f64>,
    /// Limits of the values.
    pub(super) clip: Option<[f64; 2]>,
    pub(super) reason: String,
    /// Assumption to check.
    pub(super) assumed: String,
    pub(super) question: Option<Question>,
}

/// Use of a column.
#[derive(Clone)]
pub(super) enum Use {
    Open,
    Time,
    /// Signal of this name.
    Signal(String),
    Ignored,
    /// Column without name and content that a separator at the end of each line makes.
    Blank,
}

impl Column {
    pub(super) fn new(
        number: u32,
        key: String,
        header: &str,
        unit: &str,
        values: ColumnValues,
    ) -> Self {
        Self {
            number,
            toml_key: toml_string(&key).unwrap_or_default(),
            key,
            header: header.to_owned(),
            unit_in_file: unit.to_owned(),
            own: None,
            needs_reference: false,
            is_given: false,
            obstacle: None,
            values,
            thousands: None,
            is_clock: false,
            times: Arc::default(),
            samples: Arc::default(),
            glitches: None,
            plausible: None,
            span_s: None,
            role: Use::Open,
            unit: None,
            scale: None,
            offset: None,
            clip: None,
            reason: String::new(),
            assumed: String::new(),
            question: None,
        }
    }

    /// Takes name and unit of the given mapping.
    pub(super) fn give(&mut self, name: &str, mapped: &MappedColumn) {
        self.is_given = true;
        self.unit = Some(GuessedUnit::Unit(mapped.unit));
        let Conversion {
            scale,
            offset,
            clip,
        } = mapped.conversion;
        self.scale = Some(scale).filter(|&scale| scale != 1.0);
        self.offset = Some(offset).filter(|&offset| offset != 0.0);
        self.clip = clip;
        self.plausible.clone_from(&mapped.plausible);
        "the mapping states it".clone_into(&mut self.reason);
        self.role = match name {
            TIME => Use::Time,
            name => Use::Signal(name.to_owned()),
        };
    }

    /// Takes the first signal of a pair, and returns a column with the other one.
    fn split(&mut self, pair: Pair) -> Self {
        self.clip = Some([0.0, pair.full]);
        let mut other = self.clone();
        self.role = Use::Signal(pair.signals[0].to_owned());
        other.role = Use::Signal(pair.signals[1].to_owned());
        other.scale = Some(-1.0);
        other.reason = format!("{}, at negative numbers", Excerpt::of(&self.key));
        other.assumed.clear();
        other
    }

    /// Returns name and unit of the signal.
    pub(super) fn signal(&self) -> Option<(String, String)> {
        let unit = self.unit_token().to_owned();
        match &self.role {
            Use::Time => Some((TIME.to_owned(), unit)),
            Use::Signal(name) => Some((name.clone(), unit)),
            _ => None,
        }
    }

    /// Returns whether the mapping must have a line for the column, and not its header alone.
    pub(super) fn needs_line(&self) -> bool {
        let by_itself = match (&self.role, &self.own) {
            (Use::Time, Some((name, unit))) => is_time_column(name, *unit),
            (Use::Signal(wanted), Some((name, _))) => name == wanted,
            _ => false,
        };
        !self.is_given
            && (!by_itself
                || self.is_clock
                || self.scale.is_some()
                || self.thousands.is_some()
                || self.plausible.is_some()
                || self.clip.is_some())
    }

    /// Returns the unit in the notation of a mapping.
    pub(super) fn unit_token(&self) -> &str {
        match self.is_clock {
            true => CLOCK,
            false => self.unit.as_ref().map_or("", GuessedUnit::token),
        }
    }

    /// Finds the glitches among all samples of the column; none if not all samples were kept.
    fn find_glitches(&mut self) {
        let is_whole = self.samples.len() as u64 == self.values.count + self.values.missing;
        if is_whole && !self.is_clock {
            self.glitches = Glitches::find(&self.samples);
        }
    }

    /// Takes over the range of the values without the glitches, if the signal cannot jump. Returns the assumption.
    fn refuse_glitches(&mut self) -> Option<String> {
        let glitches = self.glitches.take()?;
        let Some(GuessedUnit::Unit(unit)) = &self.unit else {
            return None;
        };
        let is_slow = matches!(
            unit.quantity(),
            Quantity::Pressure | Quantity::Temperature | Quantity::Voltage
        );
        let hard = Bounds::of(unit.quantity()).in_unit(*unit);
        let is_known = glitches.cells.iter().all(|value| !hard.contains(value));
        if !is_slow || is_known || self.is_given || !matches!(self.role, Use::Signal(_)) {
            return None;
        }
        let text = format!("{glitches}");
        self.plausible = Some(glitches.range);
        Some(text)
    }

    pub(super) fn is_current(&self) -> bool {
        matches!(
            self.unit,
            Some(GuessedUnit::Unit(Unit::Ampere | Unit::Milliampere))
        )
    }
}

/// Returns a string of TOML; `None` if the text has characters that need care.
pub(super) fn toml_string(text: &str) -> Option<String> {
    let is_plain = !text.contains(['"', '\\']) && !text.chars().any(crate::name::is_unprintable);
    is_plain.then(|| format!("\"{text}\""))
}

impl Draft {
    /// Decides what each column is.
    pub(super) fn decide(&mut self, reference: Option<PressureReference>) {
        for column in &mut self.columns {
            column.find_glitches();
            if let Some(obstacle) = column.obstacle.take().filter(|_| !column.is_given) {
                (column.role, column.reason) = (Use::Ignored, obstacle);
            }
        }
        let open: Vec<usize> = (0..self.columns.len())
            .filter(|&index| matches!(self.columns[index].role, Use::Open))
            .collect();
        let subjects: Vec<Subject> = open
            .iter()
            .map(|&index| {
                let column = &self.columns[index];
                Subject {
                    header: &column.header,
                    unit: match column.is_clock {
                        // Whatever the file states, a clock has been converted.
                        true => Unit::Second.token(),
                        false => &column.unit_in_file,
                    },
                    values: match &column.glitches {
                        Some(glitches) => &glitches.others,
                        None => &column.values,
                    },
                }
            })
            .collect();
        let rise = |valve: usize, other: Option<usize>, pressure: usize| {
            let trace = |index: usize| Trace::of(&self.columns[open[index]]);
            rise(trace(valve), other.map(trace), trace(pressure))
        };
        let has_own_time = self.format == LogFormat::Mf4
            || self
                .columns
                .iter()
                .any(|column| matches!(column.role, Use::Time));
        let guesses = guess::guess(&subjects, reference, has_own_time, &rise);
        let mut others = Vec::new();
        for (index, guess) in open.into_iter().zip(guesses) {
            let column = &mut self.columns[index];
            (column.unit, column.scale) = (guess.unit, guess.scale);
            (column.reason, column.question) = (guess.reason, guess.question);
            if column.is_clock {
                "dates or times of day".clone_into(&mut column.reason);
            }
            column.role = match (guess.signal, &column.own) {
                (None, _) if column.is_clock => Use::Ignored,
                (Some(TIME), _) => Use::Time,
                // A line without a unit is no mapping.
                (Some(signal), _) if column.unit.is_none() => {
                    column.question = Some(Question::Unit(signal));
                    Use::Ignored
                }
                (Some(signal), _) => Use::Signal(signal.to_owned()),
                // The question keeps the column out of the mapping until it is answered.
                (None, _) if column.question.is_some() => Use::Ignored,
                (None, Some((name, unit))) if !is_time_column(name, *unit) => {
                    column.unit = Some(GuessedUnit::Unit(*unit));
                    Use::Signal(name.clone())
                }
                (None, _) => Use::Ignored,
            };
            let mut assumed = vec![guess.assumed];
            assumed.extend(column.refuse_glitches());
            assumed.retain(|text| !text.is_empty());
            let assumed = assumed.join("; ");
            if !assumed.is_empty() && !matches!(column.role, Use::Ignored) {
                let text = format!("{}: {assumed}", Excerpt::of(&column.key));
                self.assumed.push(text);
                column.assumed = assumed;
            }
            others.extend(guess.pair.map(|pair| column.split(pair)));
        }
        self.columns.extend(others);
        self.columns.sort_by_key(|column| column.number);
        self.leave_names_to_the_first();
        for column in &mut self.columns {
            // The logger's own row of units may state a reference that its header does not.
            if matches!(column.question, Some(Question::Reference { .. }))
                && column.signal().is_none()
            {
                column.question = None;
            }
        }
    }

    /// Ignores a column whose name another column has.
    fn leave_names_to_the_first(&mut self) {
        let mut names: Vec<String> = Vec::new();
        // A signal of the model or of the mapping has priority over a column with that name.
        for is_first in [true, false] {
            for column in &mut self.columns {
                let Use::Signal(name) = &column.role else {
                    continue;
                };
                let is_sure =
                    column.is_given || column.own.as_ref().is_none_or(|(own, _)| own != name);
                if is_sure != is_first {
                    continue;
                }
                if names.contains(name) {
                    column.reason = format!("another column is {}", Excerpt::of(name));
                    (column.role, column.question) = (Use::Ignored, None);
                } else {
                    names.push(name.clone());
                }
            }
        }
    }
}
