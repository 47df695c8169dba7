//! Reader of all logs, in any format.

use std::io::{self, Read as _};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use recording::csv::{self, Mapping};
use recording::{
    InspectedLog, LogFormat, LogOptions, PressureReference, Recording, inspect_named_file, read_log,
};

use crate::refusal::Problem;
use crate::store::{UPLOAD_BYTES_MAX, open_regular};

/// Reads the log at `path`; `name` is its name in messages. A panic of a reader is reported as a damaged file, so that
/// no file can end the server.
///
/// # Errors
/// Returns the first problem of the file or its mapping, with its line.
pub(crate) fn read(name: &str, path: &Path, mapping: Option<&str>) -> Result<Recording, Problem> {
    catch_unwind(AssertUnwindSafe(|| read_any(name, path, mapping)))
        .unwrap_or_else(|_| Err(panicked()))
}

/// Inspects the log at `path` with its mapping; `reference` is that of pressures whose unit states none.
///
/// # Errors
/// Returns the reason why the file is no log at all.
pub(crate) fn inspect(
    name: &str,
    path: &Path,
    mapping: Option<&str>,
    reference: Option<PressureReference>,
) -> Result<InspectedLog, Problem> {
    open_regular(path).map_err(|error| not_stored(&error))?;
    let inspected = || {
        let options = options(mapping, reference)?;
        let inspection = inspect_named_file(name, path, &options, mapping);
        inspection.map_err(|error| Problem::from(&error))
    };
    let inspection =
        catch_unwind(AssertUnwindSafe(inspected)).unwrap_or_else(|_| Err(panicked()))?;
    Ok(InspectedLog::of(&inspection))
}

fn options(
    mapping: Option<&str>,
    reference: Option<PressureReference>,
) -> Result<LogOptions, Problem> {
    let mapping = match mapping {
        Some(text) => Mapping::parse_with_reference("mapping", text, reference)
            .map_err(|error| Problem::from(&error))?,
        None => Mapping::default().with_reference(reference),
    };
    Ok(LogOptions {
        mapping,
        csv_limits: csv::Limits {
            file_bytes: UPLOAD_BYTES_MAX,
            ..csv::Limits::default()
        },
        ..LogOptions::default()
    })
}

fn panicked() -> Problem {
    Problem::new(
        "E-WEB-READER",
        "the file is damaged, and the reader cannot find the place; export it again",
    )
}

fn read_any(name: &str, path: &Path, mapping: Option<&str>) -> Result<Recording, Problem> {
    let options = options(mapping, None)?;
    let file = open_regular(path).map_err(|error| not_stored(&error))?;
    read_log(name, file, &options).map_err(|error| Problem::from(&error))
}

/// Returns whether the file is CSV, by its first bytes.
pub(crate) fn is_csv(path: &Path) -> bool {
    let mut begin = Vec::new();
    let read = open_regular(path).and_then(|file| file.take(128).read_to_end(&mut begin));
    read.is_err() || LogFormat::of_beginning(&begin) == LogFormat::Csv
}

fn not_stored(error: &io::Error) -> Problem {
    let kind = error.kind();
    Problem::new(
        "E-WEB-DISK",
        format!("the stored log cannot be read: {kind}; open the file again"),
    )
}
