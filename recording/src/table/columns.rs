//! Columns of a file before they are assigned to signals.

use super::error::{Located, of_file};
use super::{Limits, TableProblem};
use crate::{LogFormat, StartTime};

/// Columns of a Parquet or MATLAB file.
#[derive(Debug)]
pub(crate) struct Columns {
    /// Layout of the file, in words.
    pub(crate) layout: String,
    pub(crate) producer: Option<String>,
    pub(crate) columns: Vec<NumberColumn>,
}

/// Column with its numbers.
#[derive(Debug)]
pub(crate) struct NumberColumn {
    /// Name in a mapping: with its structures, if it is not unique without them.
    pub(crate) key: String,
    /// Name without structures; may contain the unit.
    pub(crate) header: String,
    /// Unit as the file states it; may be empty.
    pub(crate) unit: String,
    /// Numbers, NaN where missing, or the reason why the column has none over time.
    pub(crate) numbers: Result<Vec<f64>, String>,
    /// Instant at which a time is 0 s, if the column has dates.
    pub(crate) start: Option<StartTime>,
}

impl NumberColumn {
    pub(super) fn new(path: &str, header: &str, numbers: Result<Vec<f64>, String>) -> Self {
        Self {
            key: path.to_owned(),
            header: header.to_owned(),
            unit: String::new(),
            numbers,
            start: None,
        }
    }
}

impl Columns {
    /// Parses the bytes of a file.
    pub(crate) fn parse(
        bytes: Vec<u8>,
        format: LogFormat,
        limits: Limits,
    ) -> Result<Self, Located> {
        if bytes.len() as u64 > limits.file_bytes {
            return Err(of_file(TableProblem::Limit {
                budget: "bytes",
                found: bytes.len() as u64,
                bound: limits.file_bytes,
            }));
        }
        let mut columns = match format {
            LogFormat::Parquet => super::parquet::columns(bytes, limits)?,
            LogFormat::MatlabHdf5 => super::hdf5::columns(bytes, limits)?,
            _ => super::matlab::columns(&bytes, limits)?,
        };
        columns.shorten_keys();
        Ok(columns)
    }

    /// Gives each column the name without its structures as its key, where only one has it.
    fn shorten_keys(&mut self) {
        let headers: Vec<String> = self.columns.iter().map(|one| one.header.clone()).collect();
        let mut counts = std::collections::HashMap::new();
        for name in headers
            .iter()
            .chain(self.columns.iter().map(|one| &one.key))
        {
            *counts.entry(name.clone()).or_insert(0_u32) += 1;
        }
        for column in &mut self.columns {
            let is_path = column.key != column.header;
            if is_path && counts.get(&column.header) == Some(&1) {
                column.key.clone_from(&column.header);
            }
        }
    }
}

/// Counter of the values of a file.
pub(super) struct Budget {
    limits: Limits,
    values: u64,
}

impl Budget {
    pub(super) fn new(limits: Limits) -> Self {
        Self { limits, values: 0 }
    }

    /// Takes the values of one column.
    pub(super) fn take_values(&mut self, count: u64) -> Result<(), Located> {
        self.values = self.values.saturating_add(count);
        within("values", self.values, self.limits.values)
    }

    /// Checks the number of columns.
    pub(super) fn check_columns(&self, count: usize) -> Result<(), Located> {
        within("columns", count as u64, self.limits.columns as u64)
    }

    /// Checks the size of unpacked data (bytes).
    pub(super) fn check_unpacked(&self, bytes: u64) -> Result<(), Located> {
        within("bytes after unpacking", bytes, self.limits.unpacked_bytes)
    }
}

fn within(budget: &'static str, found: u64, bound: u64) -> Result<(), Located> {
    match found <= bound {
        true => Ok(()),
        false => Err(of_file(TableProblem::Limit {
            budget,
            found,
            bound,
        })),
    }
}
