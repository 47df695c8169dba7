//! One table from the tables of all shards.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::batch::RIGS;
use super::row::RigRow;
use super::settings::Difference;
use super::summary::Summary;
use super::table::{RowReader, RowWriter, TableError, damaged};

/// Reason why tables cannot be merged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// A file is no table of rigs.
    #[error("{}: {error}", path.display())]
    Table {
        /// Path of the file.
        path: PathBuf,
        /// Error of the table.
        error: TableError,
    },
    /// Two files belong to different runs.
    #[error(
        "{} and {}: shards of different runs: {difference}; merge the shards of one run", one.display(), other.display()
    )]
    OtherRun {
        /// First file.
        one: PathBuf,
        /// File of another run.
        other: PathBuf,
        /// First different setting.
        difference: Difference,
    },
    /// Rigs are in two files.
    #[error(
        "{} and {}: both have rig {first}{}; name each shard once", one.display(), other.display(), up_to(*first, *last)
    )]
    Duplicate {
        /// First file.
        one: PathBuf,
        /// Second file.
        other: PathBuf,
        /// First rig in both.
        first: u32,
        /// Last rig in both.
        last: u32,
    },
    /// Rigs are in no file.
    #[error(
        "rig {first}{} of {rigs} {} in no file; run the shards that have them, and name their files too", up_to(*first, *last),
        if first == last { "is" } else { "are" }
    )]
    Gap {
        /// First missing rig.
        first: u32,
        /// Last missing rig before the next file.
        last: u32,
        /// Number of rigs of the batch.
        rigs: u32,
    },
    /// No file was given.
    #[error("no file to merge; name the files of all shards")]
    NoFile,
    /// The table cannot be written.
    #[error("the table cannot be written: {0}")]
    Write(io::Error),
}

fn up_to(first: u32, last: u32) -> String {
    match last > first {
        true => format!(" to {last}"),
        false => String::new(),
    }
}

/// Table of a shard.
struct Part {
    path: PathBuf,
    reader: RowReader<File>,
    /// First row, already read; `None` for a shard without rigs.
    first: Option<RigRow>,
}

impl Part {
    fn open(path: &Path) -> Result<Self, MergeError> {
        let opened = || {
            let mut reader = RowReader::open(File::open(path)?)?;
            let first = reader.next().transpose()?;
            Ok((reader, first))
        };
        let (reader, first) = opened().map_err(|error| MergeError::Table {
            path: path.to_path_buf(),
            error,
        })?;
        Ok(Self {
            path: path.to_path_buf(),
            reader,
            first,
        })
    }

    fn failed(&self, error: TableError) -> MergeError {
        MergeError::Table {
            path: self.path.clone(),
            error,
        }
    }

    /// Returns the number of rigs of the whole run.
    fn rigs_of_batch(&self) -> Result<u32, MergeError> {
        let rigs = self.reader.settings().get(RIGS);
        let rigs = rigs.and_then(|rigs| rigs.parse().ok());
        rigs.ok_or_else(|| self.failed(damaged("it does not state the number of rigs")))
    }

    /// Returns the first rig and the end of the rigs.
    fn range(&self) -> (u64, u64) {
        let first = self.first.as_ref().map_or(0, |row| row.rig.into());
        (first, first + self.reader.row_count())
    }
}

/// Writes the tables of all shards of a run to `sink` as one table; `paths` may be in any order. Its bytes are those of a
/// run without shards.
///
/// # Errors
/// Returns an error if a file is no table of rigs or belongs to another run, if a rig is in no file or in two, or the
/// sink's error.
pub fn merge<W: Write + Send>(paths: &[PathBuf], sink: W) -> Result<(W, Summary), MergeError> {
    let parts = paths.iter().map(|path| Part::open(path));
    let mut parts = parts.collect::<Result<Vec<_>, _>>()?;
    let first = parts.first().ok_or(MergeError::NoFile)?;
    check_settings(first, &parts)?;
    let settings = first.reader.settings().clone();
    let rigs = first.rigs_of_batch()?;
    parts.sort_by_key(Part::range);
    check_ranges(&parts, rigs)?;
    let mut table = RowWriter::new(sink, &settings).map_err(MergeError::Write)?;
    let mut summary = Summary::default();
    for Part {
        path,
        reader,
        first,
    } in parts
    {
        let failed = |error| MergeError::Table {
            path: path.clone(),
            error,
        };
        let mut next = first.as_ref().map(|row| row.rig);
        for row in first.into_iter().map(Ok).chain(reader) {
            let row = row.map_err(failed)?;
            if Some(row.rig) != next {
                return Err(failed(damaged("its rigs are not in order")));
            }
            next = row.rig.checked_add(1);
            summary.add(&row);
            table.push(row).map_err(MergeError::Write)?;
        }
    }
    let sink = table.finish().map_err(MergeError::Write)?;
    Ok((sink, summary))
}

fn check_settings(first: &Part, parts: &[Part]) -> Result<(), MergeError> {
    let settings = first.reader.settings();
    let mut others = parts.iter();
    let differs = |part: &Part| {
        Some((
            part.path.clone(),
            settings.difference(part.reader.settings())?,
        ))
    };
    match others.find_map(differs) {
        Some((other, difference)) => Err(MergeError::OtherRun {
            one: first.path.clone(),
            other,
            difference,
        }),
        None => Ok(()),
    }
}

/// Checks that `parts`, in the order of their rigs, have each rig of `rigs` once.
fn check_ranges(parts: &[Part], rigs: u32) -> Result<(), MergeError> {
    let mut next = 0;
    let mut before: Option<&Part> = None;
    let gap = |first: u64, end: u64| MergeError::Gap {
        first: first as u32,
        last: (end - 1) as u32,
        rigs,
    };
    for part in parts.iter().filter(|part| part.first.is_some()) {
        let (begin, end) = part.range();
        match before {
            Some(before) if begin < next => {
                return Err(MergeError::Duplicate {
                    one: before.path.clone(),
                    other: part.path.clone(),
                    first: begin as u32,
                    last: (next.min(end) - 1) as u32,
                });
            }
            _ if begin > next => return Err(gap(next, begin)),
            _ => {}
        }
        if end > u64::from(rigs) {
            return Err(part.failed(damaged("it has more rigs than its run")));
        }
        next = end;
        before = Some(part);
    }
    match next < u64::from(rigs) {
        true => Err(gap(next, rigs.into())),
        false => Ok(()),
    }
}
