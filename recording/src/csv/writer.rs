use std::collections::BTreeMap;
use std::io::{self, Write};

use super::Column;
use super::header::format_heading;
use crate::name::{NameError, check_name, is_time_column, is_unprintable};
use crate::{Provenance, Recording, TimeBaseId, Unit};

/// Number of decimals for the numbers of each unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Decimals(BTreeMap<Unit, u8>);

impl Decimals {
    /// Writes the shortest text that reads back as the same bits, for every unit.
    pub fn shortest() -> Self {
        Self::default()
    }

    /// Returns the same settings with `decimals` decimals for values in `unit`; the time is in [`Unit::Second`].
    #[must_use]
    pub fn with(mut self, unit: Unit, decimals: u8) -> Self {
        self.0.insert(unit, decimals);
        self
    }
}

/// Writer of rows as CSV that [`Reader`](super::Reader) reads back: comma, decimal point, a header with units.
pub struct Writer<W: Write> {
    sink: W,
    columns: Vec<(Column, Option<u8>)>,
    time_decimals: Option<u8>,
    previous_s: f64,
    rows: u64,
    line: Vec<u8>,
}

impl<W: Write> Writer<W> {
    /// Writes the provenance as comments, and the header.
    ///
    /// # Errors
    /// Returns a [`WriteError`] for a name that no reader accepts, or for the sink's error.
    pub fn new(
        mut sink: W,
        provenance: &Provenance,
        columns: &[Column],
        decimals: &Decimals,
    ) -> Result<Self, WriteError> {
        check_columns(columns)?;
        let comment = |sink: &mut W, key: &str, value: &str| {
            writeln!(sink, "# {}: {}", one_line(key), one_line(value))
        };
        comment(&mut sink, "source", &provenance.source)?;
        if let Some(producer) = &provenance.producer {
            comment(&mut sink, "producer", producer)?;
        }
        if let Some(start) = &provenance.start {
            comment(&mut sink, "recorded", &start.to_string())?;
        }
        if let Some(input) = &provenance.input {
            comment(&mut sink, "source sha256", &input.sha256_hex())?;
        }
        for note in provenance.notes.iter() {
            comment(&mut sink, &note.key, &note.value)?;
        }
        sink.write_all(b"time_s")?;
        for column in columns {
            write!(
                sink,
                ",{}",
                quoted(&format_heading(&column.name, column.unit))
            )?;
        }
        sink.write_all(b"\n")?;
        Ok(Self {
            sink,
            columns: columns
                .iter()
                .map(|column| (column.clone(), decimals.0.get(&column.unit).copied()))
                .collect(),
            time_decimals: decimals.0.get(&Unit::Second).copied(),
            previous_s: f64::NEG_INFINITY,
            rows: 0,
            line: Vec::new(),
        })
    }

    /// Writes one row: the time (s) and one value per column, NaN where missing.
    ///
    /// # Errors
    /// Returns a [`WriteError`] for times that do not increase as written, infinite values, another number of values,
    /// or the sink's error. Nothing of the row is written then.
    pub fn write_row(&mut self, time_s: f64, values: &[f64]) -> Result<(), WriteError> {
        if values.len() != self.columns.len() {
            return Err(WriteError::ValueCount {
                row: self.rows,
                expected: self.columns.len(),
                found: values.len(),
            });
        }
        self.line.clear();
        push_number(&mut self.line, time_s, self.time_decimals);
        let written_s = match self.time_decimals {
            None => time_s,
            Some(_) => std::str::from_utf8(&self.line)
                .ok()
                .and_then(|text| text.parse().ok())
                .unwrap_or(f64::NAN),
        };
        if !written_s.is_finite() || written_s <= self.previous_s {
            return Err(WriteError::TimeOrder {
                row: self.rows,
                previous_s: self.previous_s,
                time_s: written_s,
            });
        }
        for (&value, (column, decimals)) in values.iter().zip(&self.columns) {
            self.line.push(b',');
            if value.is_infinite() {
                return Err(WriteError::Infinite {
                    row: self.rows,
                    name: column.name.clone(),
                });
            }
            if !value.is_nan() {
                push_number(&mut self.line, value, *decimals);
            }
        }
        self.line.push(b'\n');
        self.sink.write_all(&self.line)?;
        self.previous_s = written_s;
        self.rows += 1;
        Ok(())
    }

    /// Flushes and returns the sink.
    ///
    /// # Errors
    /// Returns the sink's error, or [`WriteError::NoRows`]: a file without rows could not be read.
    pub fn finish(mut self) -> Result<W, WriteError> {
        if self.rows == 0 {
            return Err(WriteError::NoRows);
        }
        self.sink.flush()?;
        Ok(self.sink)
    }
}

/// Writes the signals of one time base of a recording.
///
/// # Errors
/// Returns a [`WriteError`].
pub fn write<W: Write>(
    sink: W,
    recording: &Recording,
    time_base: TimeBaseId,
    decimals: &Decimals,
) -> Result<W, WriteError> {
    let times_s = recording
        .time_base(time_base)
        .ok_or(WriteError::NoRows)?
        .times_s();
    let signals: Vec<_> = recording
        .signals()
        .iter()
        .filter(|signal| signal.time_base() == time_base)
        .collect();
    let columns: Vec<_> = signals
        .iter()
        .map(|signal| Column {
            name: signal.name().to_owned(),
            unit: signal.unit(),
        })
        .collect();
    let mut writer = Writer::new(sink, recording.provenance(), &columns, decimals)?;
    let mut values = vec![f64::NAN; signals.len()];
    for (index, &time_s) in times_s.iter().enumerate() {
        for (value, signal) in values.iter_mut().zip(&signals) {
            *value = signal.values_or_nan()[index];
        }
        writer.write_row(time_s, &values)?;
    }
    writer.finish()
}

pub(crate) fn check_columns(columns: &[Column]) -> Result<(), WriteError> {
    if columns.is_empty() {
        return Err(WriteError::NoColumns);
    }
    let mut seen = std::collections::BTreeSet::new();
    for Column { name, unit } in columns {
        check_name(name).map_err(|problem| WriteError::Name {
            name: name.clone(),
            problem,
        })?;
        if is_time_column(name, *unit) || !seen.insert(name) {
            return Err(WriteError::NameTaken { name: name.clone() });
        }
    }
    Ok(())
}

/// Writes the shortest digits that read back as the same bits, with an exponent where plain digits would be long.
fn push_number(line: &mut Vec<u8>, value: f64, decimals: Option<u8>) {
    let size = value.abs();
    let result = match decimals {
        Some(decimals) => write!(line, "{value:.*}", usize::from(decimals)),
        None if size != 0.0 && !(1e-5..1e16).contains(&size) => write!(line, "{value:e}"),
        None => write!(line, "{value}"),
    };
    debug_assert!(result.is_ok(), "writing to memory cannot fail");
}

/// Returns a header field, quoted if necessary.
fn quoted(field: &str) -> String {
    if field.contains([',', ';', '\t', '"']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// Returns a comment as one line, without characters that control a terminal.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|character| {
            if is_unprintable(character) {
                ' '
            } else {
                character
            }
        })
        .collect()
}

/// Returns the next step for an output that could not be written.
fn next_step(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "create its folder, or name another one",
        _ => "check the free space and the rights",
    }
}

/// Reason why a row or file was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The sink failed.
    #[error("the output could not be written: {0}; {next}", next = next_step(.0))]
    Io(#[from] io::Error),
    /// There is no signal.
    #[error("there is no signal to write: give at least one column")]
    NoColumns,
    /// There is no row.
    #[error("there is no row to write: a file without rows could not be read back")]
    NoRows,
    /// A name is one that no reader accepts.
    #[error("{name:?} cannot name a signal: {problem}")]
    Name {
        /// Refused name.
        name: String,
        /// Problem of the name.
        problem: NameError,
    },
    /// Two columns have the same name, or there is a second time column.
    #[error("{name:?} is a column already: names are unique, and the time is written by itself")]
    NameTaken {
        /// Refused name.
        name: String,
    },
    /// The number of values differs from the number of columns.
    #[error(
        "row {row} has {found} values for {expected} columns: give one each, NaN where missing"
    )]
    ValueCount {
        /// Row, from 0.
        row: u64,
        /// Number of columns.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// A time does not increase, as written.
    #[error(
        "row {row} is written at {time_s} s after {previous_s} s: times must increase (more decimals?)"
    )]
    TimeOrder {
        /// Row, from 0.
        row: u64,
        /// Time of the previous row (s).
        previous_s: f64,
        /// Time of this row (s).
        time_s: f64,
    },
    /// A value is infinite.
    #[error("{name:?} is infinite in row {row}: values are finite, or NaN where missing")]
    Infinite {
        /// Row, from 0.
        row: u64,
        /// Name of the signal.
        name: String,
    },
}
