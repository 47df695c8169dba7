use std::fs::File;
use std::io::{Chain, Cursor, Read};
use std::path::Path;

use super::encoding::Encoding;
use super::error::{CsvError, Located, Place};
use super::opening::Opening;
use super::plan::Plan;
use super::problem::Problem;
use super::record::Records;
use super::row::RowParser;
use super::{Dialect, Limits, Mapping};
use crate::provenance::READER_NOTE;
use crate::{Note, OutOfBounds, Provenance, Recording, SkippedRow, TimeBase, Unit};

/// Options for reading a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Meaning of the columns, where the file does not define it.
    pub mapping: Mapping,
    /// Budgets of the reader.
    pub limits: Limits,
}

/// Signal of a CSV file: its base name and its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Base name, such as `p_ch`.
    pub name: String,
    /// Unit of the values.
    pub unit: Unit,
}

/// Reader of a CSV file, row by row. Its memory does not grow with the length of the file.
pub struct Reader<R: Read> {
    source_name: String,
    records: Records<Chain<Cursor<Vec<u8>>, R>>,
    plan: Plan,
    dialect: Dialect,
    columns: Vec<Column>,
    rows: RowParser,
    bad_rows: u64,
    skipped: Vec<SkippedRow>,
    state: State,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Reading,
    Ended,
    Failed,
}

/// One row: a time and one value per column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Line in the file, from 1.
    pub line: u64,
    /// Time (s).
    pub time_s: f64,
    /// Values in the order and the units of [`Reader::columns`], NaN where missing or out of bounds.
    pub values: &'a [f64],
}

impl Row<'_> {
    /// Returns the value of column `index`; `None` if it is missing.
    pub fn get(&self, index: usize) -> Option<f64> {
        self.values
            .get(index)
            .copied()
            .filter(|value| !value.is_nan())
    }
}

impl<R: Read> Reader<R> {
    /// Reads the head of `input` and decides on its dialect and its columns. `source_name` is used in messages.
    ///
    /// # Errors
    /// Returns a [`CsvError`] if the head is not that of a CSV log.
    pub fn new(source_name: &str, mut input: R, options: &Options) -> Result<Self, CsvError> {
        let fail = |(place, problem)| CsvError::new(source_name, place, problem);
        let Opening {
            head,
            dialect,
            plan,
            header_records,
        } = Opening::read(&mut input, options).map_err(fail)?;
        let input = Cursor::new(head).chain(input);
        let mut records = Records::new(input, dialect.encoding, dialect.delimiter, options.limits)
            .with_carriage_returns(dialect.carriage_returns);
        records
            .skip(options.mapping.skip_lines, header_records)
            .map_err(fail)?;
        let logged = plan.signals.iter().map(|signal| Column {
            name: signal.name.clone(),
            unit: signal.unit,
        });
        let constant = plan.constants.iter().map(|(name, one)| Column {
            name: name.clone(),
            unit: one.unit,
        });
        let columns = logged.chain(constant).collect();
        let rows = RowParser::new(&plan, dialect.decimal, options);
        let source_name = source_name.to_owned();
        Ok(Self {
            source_name,
            records,
            plan,
            dialect,
            columns,
            rows,
            bad_rows: options.limits.bad_rows,
            skipped: Vec::new(),
            state: State::Reading,
        })
    }

    /// Returns the signals in the order of their columns, followed by the constant ones of the mapping.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Returns the dialect of the file.
    pub fn dialect(&self) -> Dialect {
        self.dialect
    }

    /// Returns the next row; `None` at the end of the file.
    ///
    /// # Errors
    /// Returns the first problem; nothing can be read after it.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>, CsvError> {
        let error = match self.state {
            State::Ended => return Ok(None),
            State::Failed => (Place::default(), Problem::ReadAfterError),
            State::Reading => match self.advance() {
                Ok(true) => {
                    let RowParser {
                        line,
                        time_s,
                        values,
                        ..
                    } = &self.rows;
                    return Ok(Some(Row {
                        line: *line,
                        time_s: *time_s,
                        values,
                    }));
                }
                Ok(false) => {
                    self.state = State::Ended;
                    return Ok(None);
                }
                Err(error) => error,
            },
        };
        self.state = State::Failed;
        Err(CsvError::new(&self.source_name, error.0, error.1))
    }

    /// Returns the cells read so far that were out of bounds and count as missing, signal by signal.
    pub fn out_of_bounds(&self) -> impl Iterator<Item = &OutOfBounds> {
        self.rows.out_of_bounds()
    }

    /// Returns the rows skipped so far.
    pub fn skipped_rows(&self) -> &[SkippedRow] {
        &self.skipped
    }

    /// Returns source, notes, and the size and hash of the data read so far: of the whole file once it has ended.
    pub fn provenance(&mut self) -> Provenance {
        let (producer, notes): (Vec<Note>, Vec<Note>) = self
            .records
            .take_notes()
            .into_iter()
            .partition(|note| note.key == "producer");
        let mut notes = notes;
        if self.dialect.encoding != Encoding::Utf8 {
            notes.push(Note {
                key: READER_NOTE.to_owned(),
                value: format!("the text is {}; it was decoded", self.dialect.encoding),
            });
        }
        if self.dialect.carriage_returns {
            notes.push(Note {
                key: READER_NOTE.to_owned(),
                value: "the lines end with carriage returns; they were read as line feeds"
                    .to_owned(),
            });
        }
        Provenance {
            source: self.source_name.clone(),
            producer: producer.into_iter().next().map(|note| note.value),
            start: self.rows.start(),
            notes,
            input: Some(self.records.input_file()),
        }
    }

    fn advance(&mut self) -> Result<bool, Located> {
        while let Some(record) = self.records.next()? {
            let line = record.line;
            match self.rows.parse(record, &self.plan) {
                Ok(true) => return Ok(true),
                Ok(false) => {}
                Err((place, problem)) => {
                    let is_skipped = (self.skipped.len() as u64) < self.bad_rows;
                    if !is_skipped || !problem.is_of_row() {
                        return Err((place, problem));
                    }
                    let column = place.column;
                    let column =
                        column.map_or_else(String::new, |column| format!("column {column}: "));
                    self.skipped.push(SkippedRow {
                        line,
                        reason: format!("{column}{problem}"),
                    });
                }
            }
        }
        self.rows.finish(&self.plan)?;
        Ok(false)
    }
}

/// Reads all of `input` into a recording. `source_name` is used in messages and in the provenance.
///
/// # Errors
/// Returns the first problem of the file.
pub fn read<R: Read>(
    source_name: &str,
    input: R,
    options: &Options,
) -> Result<Recording, CsvError> {
    let mut reader = Reader::new(source_name, input, options)?;
    let mut times_s = Vec::new();
    let mut samples: Vec<Vec<f64>> = vec![Vec::new(); reader.columns().len()];
    while let Some(row) = reader.next_row()? {
        times_s.push(row.time_s);
        for (samples, &value) in samples.iter_mut().zip(row.values) {
            samples.push(value);
        }
    }
    let mut recording = Recording::new(reader.provenance());
    let time_base = TimeBase::new(times_s)
        .expect("the reader refuses times that do not increase or are out of bounds, and files without rows");
    let time_base = recording.add_time_base(time_base);
    for (column, samples) in reader.columns().iter().zip(samples) {
        recording
            .add_signal(column.name.clone(), column.unit, time_base, samples)
            .expect("the reader refuses names that are taken or impossible, and values that are infinite");
    }
    for row in reader.skipped_rows() {
        recording.add_skipped_row(row.clone());
    }
    for cells in reader.out_of_bounds() {
        recording.add_out_of_bounds(cells.clone());
    }
    Ok(recording)
}

/// Reads a CSV file into a recording.
///
/// # Errors
/// Returns the first problem of the file.
pub fn read_file(path: impl AsRef<Path>, options: &Options) -> Result<Recording, CsvError> {
    let path = path.as_ref();
    let source_name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy();
    let file = File::open(path).map_err(|error| {
        CsvError::new(
            &path.display().to_string(),
            Place::default(),
            Problem::Io(error),
        )
    })?;
    read(&source_name, file, options)
}
