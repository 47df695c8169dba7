//! The one door through which logs come in, whatever their format.

use std::fs::File;
use std::io::{self, Read as _};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use recording::csv::{self, Mapping};
use recording::{Recording, mf4};

use crate::refusal::Problem;
use crate::store::UPLOAD_BYTES_MAX;

/// Reads the log at `path`; `name` is what a person calls it. A reader that panics is told as a damaged file: whatever
/// the bytes are, the server goes on.
///
/// # Errors
/// The first thing that is wrong with the file or its mapping, with its line.
pub(crate) fn read(name: &str, path: &Path, mapping: Option<&str>) -> Result<Recording, Problem> {
    catch_unwind(AssertUnwindSafe(|| read_any(name, path, mapping))).unwrap_or_else(|_| {
        Err(Problem::new(
            "E-WEB-READER",
            "the file is damaged in a way that its reader does not know; export it again",
        ))
    })
}

fn read_any(name: &str, path: &Path, mapping: Option<&str>) -> Result<Recording, Problem> {
    let mapping = match mapping {
        Some(text) => Mapping::parse("mapping", text).map_err(|error| Problem::from(&error))?,
        None => Mapping::default(),
    };
    let file = File::open(path).map_err(|error| not_stored(&error))?;
    if is_mf4(path) {
        let limits = mf4::Limits::default();
        let options = mf4::Options { mapping, limits };
        return mf4::read(name, file, &options).map_err(|error| Problem::from(&error));
    }
    let limits = csv::Limits {
        file_bytes: UPLOAD_BYTES_MAX,
        ..csv::Limits::default()
    };
    let options = csv::Options { mapping, limits };
    csv::read(name, file, &options).map_err(|error| Problem::from(&error))
}

/// Whether the file begins as MF4 does, closed by its logger or not.
pub(crate) fn is_mf4(path: &Path) -> bool {
    let mut begin = [0; 8];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut begin));
    read.is_ok() && matches!(&begin, b"MDF     " | b"UnFinMF ")
}

fn not_stored(error: &io::Error) -> Problem {
    let kind = error.kind();
    Problem::new(
        "E-WEB-DISK",
        format!("the stored log cannot be read: {kind}; drop it again"),
    )
}
