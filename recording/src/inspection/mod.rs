//! Inspection of a log of unknown layout: its columns, a guess of each, and a mapping with which it can be read.

mod columns;
mod glitches;
mod json;
mod mapping_text;
mod of_file;
mod rise;

use std::fs::File;
use std::ops::RangeInclusive;
use std::path::Path;

use crate::csv::{self, CsvError, Mapping};
use crate::guess::{GuessedUnit, Question};
use crate::log::read_named_log_file;
use crate::mf4::{self, Mf4Error};
use crate::table::{self, TableError};
use crate::values::ColumnValues;
use crate::{LogError, LogFormat, LogOptions, PressureReference, Unit};
use columns::{Column, Use};
pub use json::{
    ColumnView, INSPECTION_SCHEMA, InspectedDialect, InspectedLog, InspectedLogs, ProblemView,
    QuestionView,
};

/// Signals without which the model of both valves and the chamber cannot be compared.
const NEEDED: [&str; 3] = ["duty_fill", "duty_vent", "p_ch"];

/// Content of a log, the guess of each column, and the mapping that follows from them.
#[derive(Debug)]
#[non_exhaustive]
pub struct Inspection {
    /// Name of the file.
    pub source: String,
    /// Format.
    pub format: LogFormat,
    /// Layout of the file, in words.
    pub layout: String,
    /// Dialect of a CSV file, and the number of lines before its header.
    pub dialect: Option<(csv::Dialect, u32)>,
    /// Number of rows; of an MF4 file, of its longest group.
    pub rows: u64,
    /// Time from the first to the last row (s).
    pub duration_s: Option<f64>,
    /// Columns or channels, in the order of the file.
    pub columns: Vec<InspectedColumn>,
    /// Needed signals that were found.
    pub found: Vec<&'static str>,
    /// Needed signals that were not found.
    pub missing: Vec<&'static str>,
    /// Open questions, each with the line or option that answers it.
    pub open: Vec<OpenPoint>,
    /// Assumptions of the mapping, to be checked.
    pub assumed: Vec<String>,
    /// Cells and rows that are no numbers.
    pub remarks: Vec<String>,
    /// Number of rows with another number of fields, or with texts among the numbers.
    pub bad_rows: u64,
    /// Spellings of missing samples, those of the given mapping included.
    pub missing_words: Vec<String>,
    /// Text of a mapping, TOML; `None` if the file needs none.
    pub mapping: Option<String>,
    /// Text of a mapping that also states the reference of pressures; `None` if the file needs no reference.
    pub mapping_with_reference: Option<String>,
    /// Whether a question is the reference of pressures.
    pub asks_reference: bool,
    /// Whether the log is read only if the reference of its pressures is given.
    pub needs_reference: bool,
    /// Reference that the values suggest for pressures that state none.
    pub suggested: Option<PressureReference>,
    /// Result of reading the log with the mapping.
    pub trial: Result<Trial, LogError>,
}

/// Column or channel of a log, with one of its signals.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct InspectedColumn {
    /// Position in the file, from 1; the same for two signals of one column.
    pub number: u32,
    /// Name in a mapping.
    pub key: String,
    /// Unit as the file states it; may be empty.
    pub unit_in_file: String,
    /// Rate (Hz), if known.
    pub rate_hz: Option<f64>,
    /// Statistics of its numbers, in the unit of the file.
    pub values: ColumnValues,
    /// Signal, `time`, or the own name of a column that the model does not use; `None` if it is ignored.
    pub signal: Option<String>,
    /// Unit in the notation of a mapping.
    pub unit: Option<String>,
    /// Reason of the guess.
    pub reason: String,
    /// Whether the signal is that of the header alone, without a mapping.
    pub is_by_header: bool,
    /// Factor for the numbers.
    pub scale: Option<f64>,
    /// Number added after the factor.
    pub offset: Option<f64>,
    /// Range to which the values are limited.
    pub clip: Option<[f64; 2]>,
    /// Separator of thousands.
    pub thousands: Option<char>,
    /// Range outside which values count as missing, in the unit of the mapping.
    pub plausible: Option<RangeInclusive<f64>>,
}

/// Open question, and what answers it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenPoint {
    /// Question.
    pub question: String,
    /// Line of a mapping, or option, that answers it.
    pub answer: String,
}

/// Result of reading a log with a mapping.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Names of the signals.
    pub signals: Vec<String>,
    /// Gaps and missing cells, one sentence each.
    pub defects: Vec<String>,
}

impl Inspection {
    /// Returns whether the log can be read with the mapping, has every needed signal, and leaves no question open.
    pub fn is_ready(&self) -> bool {
        self.trial.is_ok() && self.missing.is_empty() && self.open.is_empty()
    }
}

/// Inspects a log file. A mapping in `options` is kept, and `given` is its text, to which lines are added.
///
/// # Errors
/// Returns the reason why the file is no log at all.
pub fn inspect_file(
    path: impl AsRef<Path>,
    options: &LogOptions,
    given: Option<&str>,
) -> Result<Inspection, LogError> {
    let path = path.as_ref();
    let name = path.file_name().unwrap_or(path.as_os_str());
    inspect_named_file(&name.to_string_lossy(), path, options, given)
}

/// Inspects a log file whose name in the texts is `source`, such as a stored copy.
///
/// # Errors
/// Returns the same errors as [`inspect_file`].
pub fn inspect_named_file(
    source: &str,
    path: impl AsRef<Path>,
    options: &LogOptions,
    given: Option<&str>,
) -> Result<Inspection, LogError> {
    let path = path.as_ref();
    let failed = |error| CsvError::io(&path.display().to_string(), error);
    let mut file = File::open(path).map_err(failed)?;
    let format = LogFormat::of_file(&mut file).map_err(failed)?;
    let mut draft = match format {
        LogFormat::Csv => {
            let survey = csv::survey::survey(file, &options.mapping, options.csv_limits)
                .map_err(|(place, problem)| CsvError::new(source, place, problem))?;
            Draft::of_csv(survey, options)
        }
        LogFormat::Mf4 => {
            let survey = mf4::survey::survey(file, &options.mapping, options.mf4_limits)
                .map_err(|error| Mf4Error::new(source, error))?;
            Draft::of_mf4(survey, options)
        }
        format => {
            let columns = table::read_columns(file, format, options.table_limits)
                .map_err(|error| TableError::new(source, error))?;
            Draft::of_table(columns, format, options)
        }
    };
    draft.decide(options.mapping.reference);
    Ok(draft.finish(source.to_owned(), path, options, given))
}

/// Inspection under construction.
struct Draft {
    format: LogFormat,
    layout: String,
    rows: u64,
    columns: Vec<Column>,
    csv_dialect: Option<(csv::Dialect, u32)>,
    /// Lines of `[dialect]`.
    dialect: Vec<(&'static str, String)>,
    /// Spellings of missing samples.
    missing_words: Vec<String>,
    assumed: Vec<String>,
    remarks: Vec<String>,
    bad_rows: u64,
    /// Signals of the given mapping that have no column.
    constants: Vec<String>,
}

impl Draft {
    /// Returns whether a signal is found.
    fn has(&self, signal: &str) -> bool {
        let is_it = |column: &Column| column.signal().is_some_and(|(name, _)| name == signal);
        self.columns.iter().any(is_it) || self.constants.iter().any(|name| name == signal)
    }

    /// Returns the open questions. Each is asked once, of all columns that it concerns.
    fn open(&self, missing: &[&str]) -> Vec<OpenPoint> {
        let mut open: Vec<OpenPoint> = Vec::new();
        if self.format != LogFormat::Mf4 && !self.has(crate::guess::TIME) {
            open.push(OpenPoint {
                question: "no column is the time".to_owned(),
                answer: "[time] with column = NUMBER and unit = \"s\" in a mapping".to_owned(),
            });
        }
        for column in &self.columns {
            let Some(question) = &column.question else {
                continue;
            };
            let unit = column.unit.as_ref().map_or("UNIT", GuessedUnit::token);
            let shown = csv::Excerpt::of(&column.key);
            let line = |signal: &str, unit: &str| {
                crate::proposal::signal_line(signal, &column.toml_key, unit)
            };
            let point = match question {
                Question::Reference { suggested } => OpenPoint {
                    question: match suggested {
                        Some((_, evidence)) => {
                            format!("{shown}: {unit} is neither gauge nor absolute; {evidence}")
                        }
                        None => format!("{shown}: {unit} is neither gauge nor absolute"),
                    },
                    answer: match suggested {
                        Some((PressureReference::Absolute, _)) => "--pressure absolute".to_owned(),
                        Some((PressureReference::Gauge, _)) => "--pressure gauge".to_owned(),
                        None => "--pressure gauge, or --pressure absolute".to_owned(),
                    },
                },
                Question::Valve => OpenPoint {
                    question: format!("{shown}: fill or vent valve"),
                    answer: match column.is_current() {
                        true => line("i_fill", unit),
                        false => line("duty_fill", unit),
                    },
                },
                Question::Rival(signal) => OpenPoint {
                    question: format!("{shown}: may be {signal}, as another column"),
                    answer: line(signal, unit),
                },
                Question::Unit(signal) => OpenPoint {
                    question: format!("{shown}: {signal}, but its unit is not known"),
                    answer: line(signal, "UNIT"),
                },
                Question::Scale(signal) => OpenPoint {
                    question: format!("{shown}: {}", column.reason),
                    answer: format!(
                        "[signal.{signal}] with column = {}, unit, scale and offset: value = logged * scale + offset",
                        column.toml_key
                    ),
                },
            };
            // A rival or a scale matters only while its signal is missing.
            let is_asked = match question {
                Question::Rival(signal) | Question::Scale(signal) => !self.has(signal),
                Question::Valve => {
                    missing.iter().any(|name| name.starts_with("duty")) || column.is_current()
                }
                _ => true,
            };
            if is_asked {
                open.push(point);
            }
        }
        open
    }

    fn finish(
        self,
        source: String,
        path: &Path,
        options: &LogOptions,
        given: Option<&str>,
    ) -> Inspection {
        let reference = options.mapping.reference;
        let (found, missing): (Vec<&str>, Vec<&str>) =
            NEEDED.iter().partition(|signal| self.has(signal));
        let open = self.open(&missing);
        let mapping = self.mapping_text(&source, given, &missing, false);
        let states_reference = self.columns.iter().any(|column| column.needs_reference);
        let mapping_with_reference = (states_reference && reference.is_some())
            .then(|| self.mapping_text(&source, given, &missing, true))
            .flatten();
        let given_words = options.mapping.missing.iter();
        let missing_words = given_words.chain(&self.missing_words).cloned().collect();
        let asks_reference = self
            .columns
            .iter()
            .any(|column| matches!(column.question, Some(Question::Reference { .. })));
        let suggested = self
            .columns
            .iter()
            .find_map(|column| match &column.question {
                Some(Question::Reference { suggested }) => suggested.as_ref().map(|one| one.0),
                _ => None,
            });
        // An open reference does not hide the other problems of the file.
        let tried = reference.or(suggested).unwrap_or(PressureReference::Gauge);
        let reference = match self.columns.iter().any(|column| column.question.is_some()) {
            true => Some(tried),
            false => reference,
        };
        let text = mapping.as_deref().or(given);
        let trial = try_to_read(&source, path, text, reference, options);
        let needs_reference = mapping.is_none() && states_reference;
        let duration_s = self.duration_s();
        let columns = self
            .columns
            .iter()
            .map(|column| self.inspected(column, duration_s));
        Inspection {
            columns: columns.collect(),
            source,
            format: self.format,
            layout: self.layout,
            dialect: self.csv_dialect,
            rows: self.rows,
            duration_s,
            found,
            missing,
            open,
            assumed: self.assumed,
            remarks: self.remarks,
            bad_rows: self.bad_rows,
            missing_words,
            mapping,
            mapping_with_reference,
            asks_reference,
            needs_reference,
            suggested,
            trial,
        }
    }

    fn inspected(&self, column: &Column, duration_s: Option<f64>) -> InspectedColumn {
        let count = match column.values.has_own_rate() {
            true => column.values.count,
            false => column.values.count + column.values.missing,
        };
        let duration_s = column.span_s.or(duration_s);
        let rate_hz = duration_s
            .filter(|&duration_s| duration_s > 0.0 && count > 1)
            .map(|duration_s| (count - 1) as f64 / duration_s);
        let signal = column.signal();
        InspectedColumn {
            number: column.number,
            key: column.key.clone(),
            unit_in_file: column.unit_in_file.clone(),
            rate_hz: rate_hz.filter(|_| column.values.count > 0),
            values: column.values.clone(),
            unit: match &signal {
                Some((_, unit)) => Some(unit.clone()),
                None => column.unit.as_ref().map(|unit| unit.token().to_owned()),
            },
            is_by_header: signal.is_some() && !column.needs_line() && !column.is_given,
            signal: signal.map(|(name, _)| name),
            reason: column.reason.clone(),
            scale: column.scale,
            offset: column.offset,
            clip: column.clip,
            thousands: column.thousands.filter(|_| !column.is_clock),
            plausible: column.plausible.clone(),
        }
    }

    /// Returns the time from the first to the last row (s).
    fn duration_s(&self) -> Option<f64> {
        let spans = self.columns.iter().filter_map(|column| column.span_s);
        let longest = spans.fold(None, |longest: Option<f64>, span_s| {
            Some(longest.map_or(span_s, |longest| longest.max(span_s)))
        });
        let of_time = || {
            let time = self
                .columns
                .iter()
                .find(|column| matches!(column.role, Use::Time));
            let time = time?;
            let unit = match &time.unit {
                Some(GuessedUnit::Unit(unit)) => *unit,
                _ => return None,
            };
            let to_s = unit.converter(Unit::Second).ok()?;
            Some(to_s.apply(time.values.greatest - time.values.least))
        };
        longest.or_else(of_time)
    }
}

/// Reads the log with the mapping, as a command does.
fn try_to_read(
    source: &str,
    path: &Path,
    mapping: Option<&str>,
    reference: Option<PressureReference>,
    options: &LogOptions,
) -> Result<Trial, LogError> {
    let mapping = match mapping {
        None => Mapping::default().with_reference(reference),
        Some(text) => match Mapping::parse_with_reference("mapping", text, reference) {
            Ok(mapping) => mapping,
            Err(error) => {
                let error = std::io::Error::other(error.to_string());
                return Err(CsvError::io("the proposed mapping", error).into());
            }
        },
    };
    let options = LogOptions {
        mapping,
        ..options.clone()
    };
    let recording = read_named_log_file(source, path, &options)?;
    let signals = recording.signals().iter();
    Ok(Trial {
        signals: signals.map(|signal| signal.name().to_owned()).collect(),
        defects: recording.defects().sentences(),
    })
}
