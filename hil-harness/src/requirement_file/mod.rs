//! Requirements on the loop as a TOML file.
//!
//! [`THESIS_TOML`] contains every key. A key that a file omits keeps the value of the thesis.

mod error;
mod keys;
mod read;
#[cfg(test)]
mod tests;

pub use error::{Problem, RequirementFileError};
pub use keys::{KEYS, Key};

use crate::requirement::Requirement;

/// Requirements of the thesis, complete: a file to start from.
pub const THESIS_TOML: &str = include_str!("../../requirements/thesis.toml");

/// Reads requirements; `name` names the file in errors.
///
/// # Errors
/// Returns every problem of the file with its line: a key that does not exist, a value that is no number or word of its
/// key, or out of its range, or values that contradict each other.
pub fn read(text: &str, name: &str) -> Result<Requirement, RequirementFileError> {
    read::read(text, name)
}
