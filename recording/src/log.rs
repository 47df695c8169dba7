//! Logs of both formats, recognised by their content and not by their name.

use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;

use crate::Recording;
use crate::csv::{self, CsvError, Mapping};
use crate::mf4::{self, Mf4Error};

/// Number of bytes needed to recognise the format.
const BEGINNING_BYTES: u64 = 8;

/// Format of logs and recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogFormat {
    /// CSV: text with separators.
    Csv,
    /// MF4: ASAM MDF 4.
    Mf4,
}

impl LogFormat {
    /// Returns the format of a file that begins with these bytes: MF4 has a signature, everything else counts as CSV.
    pub fn of_beginning(bytes: &[u8]) -> Self {
        match bytes.starts_with(b"MDF  ") || bytes.starts_with(b"UnFinMF") {
            true => Self::Mf4,
            false => Self::Csv,
        }
    }

    /// Returns the format for a file name: MF4 for the extension `mf4`, otherwise CSV.
    pub fn of_name(path: impl AsRef<Path>) -> Self {
        let extension = path.as_ref().extension();
        match extension.is_some_and(|extension| extension.eq_ignore_ascii_case("mf4")) {
            true => Self::Mf4,
            false => Self::Csv,
        }
    }
}

/// Options for reading a log of either format.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogOptions {
    /// Meaning of the columns or channels, where the file does not define it.
    pub mapping: Mapping,
    /// Budgets for CSV.
    pub csv_limits: csv::Limits,
    /// Budgets for MF4.
    pub mf4_limits: mf4::Limits,
}

impl LogOptions {
    /// Returns the options of the CSV reader.
    pub fn csv(&self) -> csv::Options {
        csv::Options {
            mapping: self.mapping.clone(),
            limits: self.csv_limits,
        }
    }

    /// Returns the options of the MF4 reader.
    pub fn mf4(&self) -> mf4::Options {
        mf4::Options {
            mapping: self.mapping.clone(),
            limits: self.mf4_limits,
        }
    }
}

/// Refusal of a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// The log is no readable CSV.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The log is no readable MF4.
    #[error(transparent)]
    Mf4(#[from] Mf4Error),
}

impl LogError {
    /// Returns the stable code, such as `E-CSV-TIME-ORDER`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Csv(error) => error.code(),
            Self::Mf4(error) => error.code(),
        }
    }
}

/// Opened log: CSV to be read row by row, or the recording of a format that is read as a whole.
pub enum OpenLog<'a> {
    /// CSV, from its beginning.
    Csv(Box<dyn Read + 'a>),
    /// Complete recording.
    Recording(Box<Recording>),
}

/// Opens a log that cannot be read twice, such as the standard input. An MF4 log is buffered in memory meanwhile.
///
/// # Errors
/// Returns an error for an unreadable MF4, or the input's error as a CSV error.
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
    // The reader refuses one byte more than the budget, with a message.
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
/// Returns an error for an unreadable MF4, or the file's error as a CSV error.
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
/// Returns the first problem of the log.
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
/// Returns the first problem of the file.
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
