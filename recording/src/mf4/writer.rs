use std::io::{Seek, SeekFrom, Write};

use super::head::{WrittenGroup, head};
use crate::csv::writer::check_columns;
use crate::csv::{Column, WriteError};
use crate::{Provenance, Recording};

/// Writer of rows as a sorted MF4 file, version 4.10, which [`read`](super::read) reads back bit for bit: one group,
/// 64-bit floats, NaN where a sample is missing.
pub struct Writer<W: Write + Seek> {
    sink: W,
    provenance: Provenance,
    columns: Vec<Column>,
    previous_s: f64,
    rows: u64,
    record: Vec<u8>,
}

impl<W: Write + Seek> Writer<W> {
    /// Writes everything except the samples; `sink` must be empty.
    ///
    /// # Errors
    /// Returns a [`WriteError`] for a name that no reader accepts, or for the sink's error.
    pub fn new(
        mut sink: W,
        provenance: &Provenance,
        columns: &[Column],
    ) -> Result<Self, WriteError> {
        check_columns(columns)?;
        let group = WrittenGroup { columns, rows: 0 };
        sink.write_all(&group.beginning(provenance))?;
        Ok(Self {
            sink,
            provenance: provenance.clone(),
            columns: columns.to_vec(),
            previous_s: f64::NEG_INFINITY,
            rows: 0,
            record: Vec::new(),
        })
    }

    /// Writes one row: the time (s) and one value per column, NaN where missing.
    ///
    /// # Errors
    /// Returns a [`WriteError`] for times that do not increase, infinite values, another number of values, or the
    /// sink's error. Nothing of the row is written then.
    pub fn write_row(&mut self, time_s: f64, values: &[f64]) -> Result<(), WriteError> {
        if values.len() != self.columns.len() {
            return Err(WriteError::ValueCount {
                row: self.rows,
                expected: self.columns.len(),
                found: values.len(),
            });
        }
        if !time_s.is_finite() || time_s <= self.previous_s {
            return Err(WriteError::TimeOrder {
                row: self.rows,
                previous_s: self.previous_s,
                time_s,
            });
        }
        if let Some(index) = values.iter().position(|value| value.is_infinite()) {
            return Err(WriteError::Infinite {
                row: self.rows,
                name: self.columns[index].name.clone(),
            });
        }
        self.record.clear();
        for number in std::iter::once(&time_s).chain(values) {
            self.record.extend_from_slice(&number.to_le_bytes());
        }
        self.sink.write_all(&self.record)?;
        self.previous_s = time_s;
        self.rows += 1;
        Ok(())
    }

    /// Writes the number of rows, flushes, and returns the sink.
    ///
    /// # Errors
    /// Returns the sink's error, or [`WriteError::NoRows`].
    pub fn finish(mut self) -> Result<W, WriteError> {
        if self.rows == 0 {
            return Err(WriteError::NoRows);
        }
        let group = WrittenGroup {
            columns: &self.columns,
            rows: self.rows,
        };
        self.sink.seek(SeekFrom::Start(0))?;
        self.sink.write_all(&group.beginning(&self.provenance))?;
        self.sink.seek(SeekFrom::End(0))?;
        self.sink.flush()?;
        Ok(self.sink)
    }
}

impl WrittenGroup<'_> {
    /// Returns all bytes before the samples of the only group.
    fn beginning(&self, provenance: &Provenance) -> Vec<u8> {
        let mut bytes = head(provenance, std::slice::from_ref(self));
        bytes.extend_from_slice(&self.data_head());
        bytes
    }
}

/// Writes a recording, one group for each time base with signals.
///
/// # Errors
/// Returns a [`WriteError`].
pub fn write<W: Write>(mut sink: W, recording: &Recording) -> Result<W, WriteError> {
    let mut bases = Vec::new();
    for (id, base) in recording.time_bases() {
        let signals = recording.signals().iter();
        let signals: Vec<_> = signals.filter(|signal| signal.time_base() == id).collect();
        if signals.is_empty() {
            continue;
        }
        let columns: Vec<_> = signals
            .iter()
            .map(|signal| Column {
                name: signal.name().to_owned(),
                unit: signal.unit(),
            })
            .collect();
        check_columns(&columns)?;
        bases.push((base, signals, columns));
    }
    if bases.is_empty() {
        return Err(WriteError::NoColumns);
    }
    let groups: Vec<_> = bases
        .iter()
        .map(|(base, _, columns)| WrittenGroup {
            columns,
            rows: base.len() as u64,
        })
        .collect();
    sink.write_all(&head(recording.provenance(), &groups))?;
    let mut record = Vec::new();
    for ((base, signals, _), group) in bases.iter().zip(&groups) {
        sink.write_all(&group.data_head())?;
        for (index, time_s) in base.times_s().iter().enumerate() {
            record.clear();
            record.extend_from_slice(&time_s.to_le_bytes());
            for signal in signals {
                record.extend_from_slice(&signal.values_or_nan()[index].to_le_bytes());
            }
            sink.write_all(&record)?;
        }
    }
    sink.flush()?;
    Ok(sink)
}
