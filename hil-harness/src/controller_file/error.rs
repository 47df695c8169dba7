//! Problems of a controller file, and how to correct them.

use core::fmt;

use plant_sim::toml_file::{FileError, FileProblem, Unreadable};

use super::keys::{Key, tables};

/// All problems of one controller file.
pub type ControllerFileError = FileError<Problem>;

/// One problem; lines count from 1.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the variants' sentences name the fields")]
#[non_exhaustive]
pub enum Problem {
    /// The file is too large or not TOML.
    Unreadable(Unreadable),
    /// The table does not exist.
    UnknownTable { line: usize, table: String },
    /// The key does not exist.
    UnknownKey {
        line: usize,
        path: String,
        nearest: Option<String>,
    },
    /// The key belongs to an option that is not chosen.
    NoEffect { line: usize, key: &'static Key },
    /// A required key is missing; `line` is that of its table, if there is one.
    Missing {
        line: Option<usize>,
        key: &'static Key,
    },
    /// The value is neither the expected number nor the expected word.
    WrongValue {
        line: usize,
        key: &'static Key,
        found: String,
        expected: String,
    },
    /// The number does not fit into fixed point.
    NotHeld {
        line: usize,
        key: &'static Key,
        found: String,
    },
    /// Fixed point would change the number noticeably.
    TooFine {
        line: usize,
        key: &'static Key,
        found: String,
        kept: String,
    },
    /// The controller refuses the number.
    OutOfRange {
        line: usize,
        key: &'static Key,
        found: String,
        min: String,
        max: String,
        unit: &'static str,
        why: Option<String>,
    },
    /// The controller refuses the combination of numbers.
    Together { line: usize, message: String },
}

impl Problem {
    /// Returns the line in the file, from 1; `None` if the problem has no line.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Unreadable(unreadable) => unreadable.line(),
            Self::Missing { line, .. } => *line,
            Self::UnknownTable { line, .. }
            | Self::UnknownKey { line, .. }
            | Self::NoEffect { line, .. }
            | Self::WrongValue { line, .. }
            | Self::NotHeld { line, .. }
            | Self::TooFine { line, .. }
            | Self::OutOfRange { line, .. }
            | Self::Together { line, .. } => Some(*line),
        }
    }
}

impl FileProblem for Problem {
    fn line(&self) -> Option<usize> {
        self.line()
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(unreadable) => write!(f, "{unreadable}"),
            Self::UnknownTable { table, .. } => {
                let known: Vec<String> =
                    tables().iter().map(|table| format!("[{table}]")).collect();
                write!(
                    f,
                    "unknown table [{table}]; a controller file has the tables {}",
                    known.join(", ")
                )
            }
            Self::UnknownKey { path, nearest, .. } => {
                write!(f, "unknown key `{path}`; ")?;
                match nearest {
                    Some(nearest) => write!(f, "is `{nearest}` meant?"),
                    None => f.write_str("remove it"),
                }
            }
            Self::NoEffect { key, .. } => {
                write!(
                    f,
                    "`{}` has no effect with the options chosen; remove it ({})",
                    key.path(),
                    key.about
                )
            }
            Self::Missing { key, .. } => {
                write!(
                    f,
                    "`{}` is missing in [{}]; add it: {}",
                    key.name, key.table, key.about
                )
            }
            Self::WrongValue {
                key,
                found,
                expected,
                ..
            } => {
                write!(f, "`{}` = {found}; write {expected}", key.path())
            }
            Self::NotHeld { key, found, .. } => write!(
                f,
                "`{}` = {found} is beyond every setting: numbers are kept from -32768 to 32767",
                key.path()
            ),
            Self::TooFine {
                key, found, kept, ..
            } => write!(
                f,
                "`{}` = {found} would be kept as {kept}, more than 1 % off: numbers are kept in steps of 2^-16 \
                 (0.0000153); write {kept} if that is meant",
                key.path()
            ),
            Self::OutOfRange {
                key,
                found,
                min,
                max,
                unit,
                why,
                ..
            } => {
                write!(
                    f,
                    "`{}` = {found} is out of range: allowed {min} to {max} {unit}",
                    key.path()
                )?;
                if let Some(why) = why {
                    write!(f, ", {why}")?;
                }
                write!(f, " ({})", key.about)
            }
            Self::Together { message, .. } => write!(f, "{message}; change one of them"),
        }
    }
}
