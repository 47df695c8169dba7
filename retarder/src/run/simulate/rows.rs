//! Rows of a log, in chunks.

use std::io::Read;

use model_lab::LogConditions;
use recording::csv::{Column, Reader};
use recording::{DefectCounter, Defects, Provenance, Recording, TimeBase};

use crate::failure::Failure;

/// Rows in memory at a time.
const CHUNK_ROWS: usize = 4096;
/// Signals of a log that determine the clock of its logger.
const MEASURED: [&str; 3] = ["p_ch", "i_fill", "i_vent"];

/// Rows of a log: a CSV file read in chunks, or a recording that was read as a whole.
pub(super) enum Rows<R: Read> {
    Csv(Box<Reader<R>>, DefectCounter),
    Recording(Option<Box<Recording>>, Defects),
}

impl<R: Read> Rows<R> {
    /// Returns the next rows, or `None` at the end. A recording comes in one chunk. The first chunk of a CSV file with
    /// measured signals is the beginning of the log that the search for the clock of the logger needs.
    pub(super) fn next(&mut self, log: &str, is_first: bool) -> Result<Option<Recording>, Failure> {
        match self {
            Self::Csv(reader, counter) => {
                let is_measured = |column: &Column| MEASURED.contains(&&*column.name);
                let is_part = match is_first && reader.columns().iter().any(is_measured) {
                    true => LogConditions::is_in_beginning,
                    false => |index, _| index < CHUNK_ROWS,
                };
                let rows = next_rows(reader, log, is_part)?;
                if let Some(rows) = &rows {
                    counter.add(rows);
                }
                Ok(rows)
            }
            Self::Recording(recording, _) => Ok(recording.take().map(|recording| *recording)),
        }
    }

    /// Returns the defects of the rows so far.
    pub(super) fn defects(self) -> Defects {
        match self {
            Self::Csv(reader, counter) => {
                let outside: Vec<_> = reader.out_of_bounds().collect();
                let skipped = reader.skipped_rows().to_vec();
                Defects {
                    skipped,
                    ..counter.finish(outside.iter().copied())
                }
            }
            Self::Recording(_, defects) => defects,
        }
    }
}

/// Returns the next rows as long as `is_part` is true. It gets the number of rows so far and the time (s) from the
/// first of them to the last.
fn next_rows(
    reader: &mut Reader<impl Read>,
    log: &str,
    is_part: fn(usize, f64) -> bool,
) -> Result<Option<Recording>, Failure> {
    let columns = reader.columns().to_vec();
    let mut times_s: Vec<f64> = Vec::with_capacity(CHUNK_ROWS);
    let mut samples = vec![Vec::with_capacity(CHUNK_ROWS); columns.len()];
    let time_s = |times_s: &[f64]| times_s.last().map_or(0.0, |last| last - times_s[0]);
    while is_part(times_s.len(), time_s(&times_s))
        && let Some(row) = reader.next_row()?
    {
        times_s.push(row.time_s);
        for (samples, &value) in samples.iter_mut().zip(row.values) {
            samples.push(value);
        }
    }
    if times_s.is_empty() {
        return Ok(None);
    }
    let mut recording = Recording::new(Provenance::from_source(log));
    let base = TimeBase::new(times_s).expect("the reader refuses times that do not increase");
    let base = recording.add_time_base(base);
    for (column, samples) in columns.into_iter().zip(samples) {
        recording
            .add_signal(column.name, column.unit, base, samples)
            .expect("the reader refuses names that are taken or impossible");
    }
    Ok(Some(recording))
}
