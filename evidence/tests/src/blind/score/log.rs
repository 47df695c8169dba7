//! Columns of a log, for the rules that read it themselves.

use std::fs;
use std::path::Path;

use super::ScoreError;

/// Log of a rig.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Log {
    columns: Vec<(String, Vec<f64>)>,
}

impl Log {
    pub(super) fn read(path: &Path) -> Result<Self, ScoreError> {
        fs::read_to_string(path)
            .map(|text| Self::parse(&text))
            .map_err(|error| ScoreError::Read(path.to_owned(), error))
    }

    /// Reads a header, then numbers; other text becomes NaN.
    pub(super) fn parse(text: &str) -> Self {
        let mut lines = text.lines();
        let header = lines.next().unwrap_or_default();
        let mut columns: Vec<_> = header
            .split(',')
            .map(|name| (name.to_owned(), Vec::new()))
            .collect();
        for line in lines {
            for ((_, column), cell) in columns.iter_mut().zip(line.split(',')) {
                column.push(cell.parse().unwrap_or(f64::NAN));
            }
        }
        Self { columns }
    }

    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        let mut columns = self.columns.iter();
        columns
            .find(|(column, _)| column == name)
            .map(|(_, values)| values.as_slice())
    }

    pub(super) fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, values)| values.len())
    }
}
