//! A log of either format: by what is in it, not by its name.

use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;

use crate::Recording;
use crate::csv::{self, CsvError, Mapping};
use crate::mf4::{self, Mf4Error};

/// Enough of a file to know its format.
const BEGINNING_BYTES: u64 = 8;

/// A format of logs and recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogFormat {
    /// Text with separators.
    Csv,
    /// ASAM MDF 4.
    Mf4,
}

impl LogFormat {
    /// The format of a file that begins with these bytes: MF4 says so, all else is taken for CSV.
    pub fn of_beginning(bytes: &[u8]) -> Self {
        match bytes.starts_with(b"MDF  ") || bytes.starts_with(b"UnFinMF") {
            true => Self::Mf4,
            false => Self::Csv,
        }
    }

    /// The format that a file of this name should have: MF4 by the extension `mf4`, else CSV.
    pub fn of_name(path: impl AsRef<Path>) -> Self {
        let extension = path.as_ref().extension();
        match extension.is_some_and(|extension| extension.eq_ignore_ascii_case("mf4")) {
            true => Self::Mf4,
            false => Self::Csv,
        }
    }
}

/// What to know before a log is read, whatever its format.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogOptions {
    /// What the columns or channels are, where the file does not say it.
    pub mapping: Mapping,
    /// Budgets for CSV.
    pub csv_limits: csv::Limits,
    /// Budgets for MF4.
    pub mf4_limits: mf4::Limits,
}

impl LogOptions {
    /// The options of the CSV reader.
    pub fn csv(&self) -> csv::Options {
        csv::Options {
            mapping: self.mapping.clone(),
            limits: self.csv_limits,
        }
    }

    /// The options of the MF4 reader.
    pub fn mf4(&self) -> mf4::Options {
        mf4::Options {
            mapping: self.mapping.clone(),
            limits: self.mf4_limits,
        }
    }
}

/// Why a log was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// It is no CSV that can be read.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// It is no MF4 that can be read.
    #[error(transparent)]
    Mf4(#[from] Mf4Error),
}

impl LogError {
    /// The stable code, such as `E-CSV-TIME-ORDER`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Csv(error) => error.code(),
            Self::Mf4(error) => error.code(),
        }
    }
}

/// A log that was opened: CSV to be read row by row, or the recording of a format that is read as a whole.
pub enum OpenLog<'a> {
    /// CSV, from its beginning on.
    Csv(Box<dyn Read + 'a>),
    /// What was read.
    Recording(Box<Recording>),
}

/// Opens a log that cannot be read twice, such as the standard input. MF4 is held in memory meanwhile.
///
/// # Errors
/// MF4 that cannot be read; or the input's error, as that of a CSV.
pub fn open_log<'a>(
    source_name: &str,
    mut input: impl Read + 'a,
    options: &LogOptions,
) -> Result<OpenLog<'a>, LogError> {
    let failed = |error| CsvError::io(source_name, error);
    let mut beginning = Vec::new();
    input
        .by_ref()
        .take(BEGINNING_BYTES)
        .read_to_end(&mut beginning)
        .map_err(failed)?;
    if LogFormat::of_beginning(&beginning) == LogFormat::Csv {
        return Ok(OpenLog::Csv(Box::new(Cursor::new(beginning).chain(input))));
    }
    // One byte more than the budget is refused by the reader, which says so.
    let rest = options.mf4_limits.file_bytes.saturating_add(1) - BEGINNING_BYTES;
    input
        .take(rest)
        .read_to_end(&mut beginning)
        .map_err(failed)?;
    let recording = mf4::read(source_name, Cursor::new(beginning), &options.mf4())?;
    Ok(OpenLog::Recording(Box::new(recording)))
}

/// Opens a log file.
///
/// # Errors
/// MF4 that cannot be read; or the file's error, as that of a CSV.
pub fn open_log_file(
    path: impl AsRef<Path>,
    options: &LogOptions,
) -> Result<OpenLog<'static>, LogError> {
    let path = path.as_ref();
    let failed = |error| CsvError::io(&path.display().to_string(), error);
    let name = path.file_name().unwrap_or(path.as_os_str());
    let name = name.to_string_lossy();
    let mut file = File::open(path).map_err(failed)?;
    // A pipe cannot be rewound.
    if !file.metadata().map_err(failed)?.is_file() {
        return open_log(&name, file, options);
    }
    let mut beginning = Vec::new();
    let read = file
        .by_ref()
        .take(BEGINNING_BYTES)
        .read_to_end(&mut beginning);
    read.and_then(|_| file.rewind()).map_err(failed)?;
    match LogFormat::of_beginning(&beginning) {
        LogFormat::Csv => Ok(OpenLog::Csv(Box::new(file))),
        LogFormat::Mf4 => {
            let recording = mf4::read(&name, file, &options.mf4())?;
            Ok(OpenLog::Recording(Box::new(recording)))
        }
    }
}

/// Reads a log that cannot be read twice into a recording.
///
/// # Errors
/// The first thing that is wrong with it.
pub fn read_log(
    source_name: &str,
    input: impl Read,
    options: &LogOptions,
) -> Result<Recording, LogError> {
    match open_log(source_name, input, options)? {
        OpenLog::Csv(input) => Ok(csv::read(source_name, input, &options.csv())?),
        OpenLog::Recording(recording) => Ok(*recording),
    }
}

/// Reads a log file into a recording.
///
/// # Errors
/// The first thing that is wrong with the file.
pub fn read_log_file(path: impl AsRef<Path>, options: &LogOptions) -> Result<Recording, LogError> {
    let path = path.as_ref();
    match open_log_file(path, options)? {
        OpenLog::Csv(input) => {
            let name = path.file_name().unwrap_or(path.as_os_str());
            Ok(csv::read(&name.to_string_lossy(), input, &options.csv())?)
        }
        OpenLog::Recording(recording) => Ok(*recording),
    }
}
