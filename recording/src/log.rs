//! Logs of all formats, recognised by their content and not by their name.

use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;

use crate::Recording;
use crate::csv::{self, CsvError, Mapping};
use crate::mf4::{self, Mf4Error};
use crate::table::{self, TableError};

/// Number of bytes needed to recognise the format.
const BEGINNING_BYTES: u64 = 128;

/// Format of logs and recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogFormat {
    /// CSV: text with separators.
    Csv,
    /// MF4: ASAM MDF 4.
    Mf4,
    /// Parquet.
    Parquet,
    /// MATLAB v5, also of `save -v7`.
    Matlab,
    /// MATLAB v7.3 and other HDF5.
    MatlabHdf5,
}

impl LogFormat {
    /// Returns the format of a file that begins with these bytes, by its signature; everything else counts as CSV.
    pub fn of_beginning(bytes: &[u8]) -> Self {
        // A MATLAB file has its version and byte order at the end of 128 bytes with any text.
        let is_matlab = |bytes: &[u8]| matches!(bytes, [0, 1, b'I', b'M'] | [1, 0, b'M', b'I']);
        if bytes.starts_with(b"MDF  ") || bytes.starts_with(b"UnFinMF") {
            Self::Mf4
        } else if bytes.starts_with(b"PAR1") {
            Self::Parquet
        } else if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(b"\x89HDF\r\n\x1a\n") {
            Self::MatlabHdf5
        } else if bytes.starts_with(b"MATLAB 5.0") || bytes.get(124..128).is_some_and(is_matlab) {
            Self::Matlab
        } else {
            Self::Csv
        }
    }

    /// Returns the format of an open file, and rewinds it.
    pub(crate) fn of_file(file: &mut File) -> std::io::Result<Self> {
        let mut beginning = Vec::new();
        file.by_ref()
            .take(BEGINNING_BYTES)
            .read_to_end(&mut beginning)?;
        file.rewind()?;
        Ok(Self::of_beginning(&beginning))
    }

    /// Returns the format for a file name by its extension: `mf4`, `parquet`, `mat` (v5), otherwise CSV.
    pub fn of_name(path: impl AsRef<Path>) -> Self {
        let extension = path.as_ref().extension().unwrap_or_default();
        let is = |wanted: &str| extension.eq_ignore_ascii_case(wanted);
        match extension {
            _ if is("mf4") => Self::Mf4,
            _ if is("parquet") => Self::Parquet,
            _ if is("mat") => Self::Matlab,
            _ if is("h5") || is("hdf5") => Self::MatlabHdf5,
            _ => Self::Csv,
        }
    }

    /// Returns the name of the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "CSV",
            Self::Mf4 => "MF4",
            Self::Parquet => "Parquet",
            Self::Matlab => "MATLAB v5/v7",
            Self::MatlabHdf5 => "MATLAB v7.3",
        }
    }
}

/// Options for reading a log of any format.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogOptions {
    /// Meaning of the columns or channels, where the file does not define it.
    pub mapping: Mapping,
    /// Budgets for CSV.
    pub csv_limits: csv::Limits,
    /// Budgets for MF4.
    pub mf4_limits: mf4::Limits,
    /// Budgets for Parquet and MATLAB.
    pub table_limits: table::Limits,
}

impl LogOptions {
    /// Returns the options of the reader of Parquet and MATLAB.
    pub fn table(&self) -> table::Options {
        table::Options {
            mapping: self.mapping.clone(),
            limits: self.table_limits,
        }
    }

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
    /// The log is no readable Parquet or MATLAB file.
    #[error(transparent)]
    Table(#[from] TableError),
}

impl LogError {
    /// Returns the stable code, such as `E-CSV-TIME-ORDER`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Csv(error) => error.code(),
            Self::Mf4(error) => error.code(),
            Self::Table(error) => error.code(),
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
/// Returns an error for an unreadable file of another format, or the input's error as a CSV error.
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
    match LogFormat::of_beginning(&beginning) {
        LogFormat::Csv => {
            return Ok(OpenLog::Csv(Box::new(Cursor::new(beginning).chain(input))));
        }
        LogFormat::Mf4 => {}
        format => {
            let input = Cursor::new(beginning).chain(input);
            let recording = table::read(source_name, input, format, &options.table())?;
            return Ok(OpenLog::Recording(Box::new(recording)));
        }
    }
    // The reader refuses one byte more than the budget, with a message.
    let most = options.mf4_limits.file_bytes.saturating_add(1);
    let rest = most.saturating_sub(BEGINNING_BYTES);
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
/// Returns an error for an unreadable file of another format, or the file's error as a CSV error.
pub fn open_log_file(
    path: impl AsRef<Path>,
    options: &LogOptions,
) -> Result<OpenLog<'static>, LogError> {
    let path = path.as_ref();
    let name = path.file_name().unwrap_or(path.as_os_str());
    open_named(&name.to_string_lossy(), path, options)
}

fn open_named(name: &str, path: &Path, options: &LogOptions) -> Result<OpenLog<'static>, LogError> {
    let failed = |error| CsvError::io(&path.display().to_string(), error);
    let mut file = File::open(path).map_err(failed)?;
    // A pipe cannot be rewound.
    if !file.metadata().map_err(failed)?.is_file() {
        return open_log(name, file, options);
    }
    match LogFormat::of_file(&mut file).map_err(failed)? {
        LogFormat::Csv => Ok(OpenLog::Csv(Box::new(file))),
        LogFormat::Mf4 => {
            let recording = mf4::read(name, file, &options.mf4())?;
            Ok(OpenLog::Recording(Box::new(recording)))
        }
        format => {
            let recording = table::read(name, file, format, &options.table())?;
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
    let name = path.file_name().unwrap_or(path.as_os_str());
    read_named_log_file(&name.to_string_lossy(), path, options)
}

/// Reads a log file whose name in the texts is `source_name`.
///
/// # Errors
/// Returns the first problem of the file.
pub(crate) fn read_named_log_file(
    source_name: &str,
    path: &Path,
    options: &LogOptions,
) -> Result<Recording, LogError> {
    match open_named(source_name, path, options)? {
        OpenLog::Csv(input) => Ok(csv::read(source_name, input, &options.csv())?),
        OpenLog::Recording(recording) => Ok(*recording),
    }
}
