//! Columns of an inspection: what the file states about each, and what it is used for.

use std::sync::Arc;

use super::Draft;
use crate::csv::header::parse_heading_over_unit;
use crate::csv::mapping::{CLOCK, ColumnKey, MappedColumn};
use crate::csv::{self, Excerpt};
use crate::guess::{self, GuessedUnit, Question, Subject, TIME};
use crate::name::is_time_column;
use crate::values::ColumnValues;
use crate::{LogFormat, LogOptions, PressureReference, Unit, mf4};

/// Column of the file.
pub(super) struct Column {
    /// Name in a mapping, and the same in TOML.
    pub(super) key: String,
    pub(super) toml_key: String,
    header: String,
    pub(super) unit_in_file: String,
    /// Name and unit that the header states by itself.
    own: Option<(String, Unit)>,
    /// Whether the header states them only with the given reference.
    pub(super) needs_reference: bool,
    /// Whether the given mapping explains the column.
    pub(super) is_given: bool,
    /// Reason why it can be no signal.
    obstacle: Option<String>,
    pub(super) values: ColumnValues,
    pub(super) thousands: Option<char>,
    /// Whether the column has dates or times of day, which a mapping must state.
    pub(super) is_clock: bool,
    times: Arc<Vec<f64>>,
    samples: Arc<Vec<f64>>,
    /// Time from the first to the last sample (s), if the column has its own instants.
    pub(super) span_s: Option<f64>,
    pub(super) role: Use,
    pub(super) unit: Option<GuessedUnit>,
    pub(super) scale: Option<f64>,
    pub(super) reason: String,
    /// Assumption to check.
    pub(super) assumed: String,
    pub(super) question: Option<Question>,
}

/// Use of a column.
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
    fn new(key: String, header: &str, unit: &str, values: ColumnValues) -> Self {
        Self {
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
            span_s: None,
            role: Use::Open,
            unit: None,
            scale: None,
            reason: String::new(),
            assumed: String::new(),
            question: None,
        }
    }

    /// Takes name and unit of the given mapping.
    fn give(&mut self, name: &str, mapped: &MappedColumn) {
        self.is_given = true;
        self.unit = Some(GuessedUnit::Unit(mapped.unit));
        "the mapping states it".clone_into(&mut self.reason);
        self.role = match name {
            TIME => Use::Time,
            name => Use::Signal(name.to_owned()),
        };
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
            && (!by_itself || self.is_clock || self.scale.is_some() || self.thousands.is_some())
    }

    /// Returns the unit in the notation of a mapping.
    pub(super) fn unit_token(&self) -> &str {
        match self.is_clock {
            true => CLOCK,
            false => self.unit.as_ref().map_or("", GuessedUnit::token),
        }
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
    pub(super) fn of_csv(survey: csv::survey::Survey, options: &LogOptions) -> Self {
        let mapping = &options.mapping;
        let reference = mapping.reference;
        let has_header = survey.header_line.is_some();
        let rows = survey.columns.iter().map(|column| column.kept.len()).max();
        let times = Arc::new(
            (0..rows.unwrap_or(0))
                .map(|row| row as f64)
                .collect::<Vec<_>>(),
        );
        let width = survey.headers.len();
        let mut missing_words: Vec<String> = Vec::new();
        let mut bad_rows = survey.ragged;
        let mut remarks = Vec::new();
        let mut columns = Vec::with_capacity(width);
        for (field, found) in survey.columns.into_iter().enumerate() {
            let number = field as u32 + 1;
            let header = &survey.headers[field];
            let unit = survey
                .units
                .as_ref()
                .map_or("", |units| units[field].as_str());
            let is_unique = survey
                .headers
                .iter()
                .filter(|other| *other == header)
                .count()
                == 1;
            let is_named = has_header && is_unique && !header.is_empty();
            let key = match is_named && toml_string(header).is_some() {
                true => header.clone(),
                false => number.to_string(),
            };
            let mut column = Column::new(key, header, unit, found.values);
            if column.key != *header {
                column.toml_key = number.to_string();
            }
            if has_header {
                let own = |reference| parse_heading_over_unit(header, unit, reference).ok();
                column.own = own(reference).map(|heading| (heading.name, heading.unit));
                column.needs_reference = column.own.is_some() && own(None).is_none();
            } else {
                column.header = String::new();
            }
            (column.thousands, column.times) = (found.thousands, Arc::clone(&times));
            column.is_clock = found.is_clock;
            column.samples = Arc::new(found.kept);
            let is_key = |key: &ColumnKey| key.is(number, header);
            if let Some(time) = mapping.time.as_ref().filter(|time| is_key(&time.column)) {
                column.give(TIME, time);
            } else if let Some((name, mapped)) =
                mapping.signals.iter().find(|(_, one)| is_key(&one.column))
            {
                column.give(name, mapped);
            } else if mapping.ignore.iter().any(is_key) {
                (column.role, column.is_given) = (Use::Ignored, true);
                "the mapping ignores it".clone_into(&mut column.reason);
            } else if field + 1 == width
                && width > 1
                && header.is_empty()
                && column.values.count == 0
                && found.texts == 0
            {
                column.role = Use::Blank;
                "a separator at the end of each line".clone_into(&mut column.reason);
            } else if found.texts > column.values.count {
                column.obstacle = Some(match &found.first_text {
                    Some((_, text)) => format!("texts such as {text}"),
                    None => "texts".to_owned(),
                });
            }
            if column.obstacle.is_none() && !matches!(column.role, Use::Ignored | Use::Blank) {
                missing_words.extend(found.missing_words);
                bad_rows += found.texts;
                if let Some((line, text)) = &found.first_text {
                    remarks.push(format!(
                        "{}: {} cells are no numbers, the first is {text} in line {line}",
                        Excerpt::of(&column.key),
                        found.texts
                    ));
                }
            }
            columns.push(column);
        }
        missing_words.sort();
        missing_words.dedup();
        missing_words.retain(|word| toml_string(word).is_some());
        if let Some((line, fields)) = survey.first_ragged {
            remarks.push(format!(
                "{} rows do not have {width} fields, the first is line {line} with {fields}",
                survey.ragged
            ));
        }
        let mut layout = format!("CSV, {}", survey.dialect);
        match survey.skip_lines {
            0 => {}
            1 => layout += ", after 1 line of preamble",
            lines => layout += &format!(", after {lines} lines of preamble"),
        }
        let assumed = match survey.is_decimal_assumed {
            true => vec![format!(
                "the decimal separator is `{}`, although some numbers allow the other reading",
                survey.dialect.decimal.symbol()
            )],
            false => Vec::new(),
        };
        Self {
            format: LogFormat::Csv,
            layout,
            rows: survey.rows,
            columns,
            dialect: survey.stated,
            missing_words,
            assumed,
            remarks,
            bad_rows,
            constants: mapping.constants.keys().cloned().collect(),
        }
    }

    pub(super) fn of_mf4(survey: mf4::survey::Survey, options: &LogOptions) -> Self {
        let mapping = &options.mapping;
        let mut remarks = Vec::new();
        if let Some(reason) = survey.obstacle {
            remarks.push(format!("no numbers were read: {reason}"));
        }
        let mut rows = 0;
        let mut columns = Vec::with_capacity(survey.channels.len());
        for channel in survey.channels {
            rows = rows.max(channel.samples.len() as u64);
            let mut column = Column::new(channel.key, &channel.name, &channel.unit, channel.values);
            column.own = channel.own;
            let strict = parse_heading_over_unit(&channel.name, &channel.unit, None);
            column.needs_reference = column.own.is_some() && strict.is_err();
            column.obstacle = channel.obstacle;
            if column.toml_key.is_empty() {
                column.obstacle =
                    Some("its name has characters that a mapping cannot have".to_owned());
            }
            column.span_s = channel
                .times_s
                .first()
                .zip(channel.times_s.last())
                .map(|(first, last)| last - first);
            (column.times, column.samples) = (channel.times_s, channel.samples);
            let is_key = |key: &ColumnKey| match key {
                ColumnKey::Header(wanted) => *wanted == column.key || *wanted == column.header,
                ColumnKey::Number(_) => false,
            };
            let given = mapping.signals.iter().find(|(_, one)| is_key(&one.column));
            if mapping.ignore.iter().any(is_key) {
                (column.role, column.is_given) = (Use::Ignored, true);
                "the mapping ignores it".clone_into(&mut column.reason);
            } else if let Some((name, mapped)) = given {
                column.give(name, mapped);
            }
            columns.push(column);
        }
        let groups = match survey.groups {
            1 => "1 group".to_owned(),
            count => format!("{count} groups"),
        };
        let version = f64::from(survey.version) / 100.0;
        let producer = survey.producer.map_or_else(String::new, |name| {
            format!(", written by {}", Excerpt::of(&name))
        });
        Self {
            format: LogFormat::Mf4,
            layout: format!("MF4, version {version:.2}, {groups} of channels{producer}"),
            rows,
            columns,
            dialect: Vec::new(),
            missing_words: Vec::new(),
            assumed: Vec::new(),
            remarks,
            bad_rows: 0,
            constants: mapping.constants.keys().cloned().collect(),
        }
    }

    /// Decides what each column is.
    pub(super) fn decide(&mut self, reference: Option<PressureReference>) {
        for column in &mut self.columns {
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
                    values: &column.values,
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
            if !guess.assumed.is_empty() && !matches!(column.role, Use::Ignored) {
                let text = format!("{}: {}", Excerpt::of(&column.key), guess.assumed);
                self.assumed.push(text);
                column.assumed = guess.assumed;
            }
        }
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

/// Samples of a column.
#[derive(Clone, Copy)]
struct Trace<'a> {
    times: &'a [f64],
    samples: &'a [f64],
    /// Value above which a valve counts as on.
    on: f64,
    range: f64,
}

impl<'a> Trace<'a> {
    /// Share of the greatest value above which a valve counts as on.
    const ON: f64 = 0.1;

    fn of(column: &'a Column) -> Self {
        Self {
            times: &column.times,
            samples: &column.samples,
            on: Self::ON * column.values.greatest,
            range: column.values.greatest - column.values.least,
        }
    }
}

/// Returns the change of the pressure while a valve is on and the other one is off, as a share of its range.
fn rise(valve: Trace<'_>, other: Option<Trace<'_>>, pressure: Trace<'_>) -> Option<f64> {
    let mut valve_is_on = Last::of(valve);
    let mut other_is_on = other.map(Last::of);
    let present = pressure.times.iter().zip(pressure.samples);
    let mut present = present.filter(|(_, sample)| !sample.is_nan()).peekable();
    let (mut sum, mut count) = (0.0, 0_u64);
    while let Some((&time, &value)) = present.next() {
        let is_on = valve_is_on.is_on_at(time);
        let is_other_on = other_is_on
            .as_mut()
            .is_some_and(|other| other.is_on_at(time));
        if let (Some(&(_, &next)), true, false) = (present.peek(), is_on, is_other_on) {
            (sum, count) = (sum + next - value, count + 1);
        }
    }
    (count > 0 && pressure.range > 0.0).then(|| sum / pressure.range)
}

/// Last known sample of a trace.
struct Last<'a> {
    trace: Trace<'a>,
    next: usize,
    value: f64,
}

impl<'a> Last<'a> {
    fn of(trace: Trace<'a>) -> Self {
        Self {
            trace,
            next: 0,
            value: 0.0,
        }
    }

    fn is_on_at(&mut self, time: f64) -> bool {
        while self
            .trace
            .times
            .get(self.next)
            .is_some_and(|&at| at <= time)
        {
            let sample = self
                .trace
                .samples
                .get(self.next)
                .copied()
                .unwrap_or(f64::NAN);
            if !sample.is_nan() {
                self.value = sample;
            }
            self.next += 1;
        }
        self.trace.on > 0.0 && self.value > self.trace.on
    }
}
