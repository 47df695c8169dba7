//! The one door through which logs come in, whatever their format.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use recording::Recording;
use recording::csv::{self, Limits, Mapping};

use crate::refusal::Problem;
use crate::store::UPLOAD_BYTES_MAX;

/// Reads the log at `path`; `name` is what a person calls it. A reader that panics is told as a damaged file: whatever
/// the bytes are, the server goes on.
///
/// # Errors
/// The first thing that is wrong with the file or its mapping, with its line.
pub(crate) fn read(name: &str, path: &Path, mapping: Option<&str>) -> Result<Recording, Problem> {
    catch_unwind(AssertUnwindSafe(|| read_csv(name, path, mapping))).unwrap_or_else(|_| {
        Err(Problem::new(
            "E-WEB-READER",
            "the file is damaged in a way that its reader does not know; export it again",
        ))
    })
}

fn read_csv(name: &str, path: &Path, mapping: Option<&str>) -> Result<Recording, Problem> {
    let mapping = match mapping {
        Some(text) => Mapping::parse("mapping", text).map_err(|error| Problem::from(&error))?,
        None => Mapping::default(),
    };
    let options = csv::Options {
        mapping,
        limits: Limits {
            file_bytes: UPLOAD_BYTES_MAX,
            ..Limits::default()
        },
    };
    let file = File::open(path).map_err(|error| {
        Problem::new(
            "E-WEB-DISK",
            format!(
                "the stored log cannot be read: {}; drop it again",
                error.kind()
            ),
        )
    })?;
    csv::read(name, file, &options).map_err(|error| Problem::from(&error))
}
