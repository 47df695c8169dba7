//! Problems of a controller file, and how to correct them.

use core::fmt;

use super::keys::{Key, tables};

/// All problems of one controller file.
#[derive(Clone, Debug)]
pub struct ControllerFileError {
    file: String,
    problems: Vec<Problem>,
}

/// One problem; lines count from 1.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the variants' sentences name the fields")]
#[non_exhaustive]
pub enum Problem {
    /// The file is too large for a controller file.
    Size { bytes: usize, bytes_max: usize },
    /// The file is not TOML.
    Syntax { line: usize, message: String },
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

impl ControllerFileError {
    pub(super) fn new(file: &str, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|problem| problem.line().unwrap_or(usize::MAX));
        Self {
            file: file.to_owned(),
            problems,
        }
    }

    /// Returns the problems, in the order of the file.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }
}

impl Problem {
    /// Returns the line in the file, from 1; `None` if the problem has no line.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Size { .. } => None,
            Self::Missing { line, .. } => *line,
            Self::Syntax { line, .. }
            | Self::UnknownTable { line, .. }
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

impl core::error::Error for ControllerFileError {}

impl fmt::Display for ControllerFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, problem) in self.problems.iter().enumerate() {
            if n > 0 {
                writeln!(f)?;
            }
            match problem.line() {
                Some(line) => write!(f, "{}:{line}: {problem}", self.file)?,
                None => write!(f, "{}: {problem}", self.file)?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { bytes, bytes_max } => {
                write!(
                    f,
                    "{bytes} bytes, more than the {bytes_max} of any controller file"
                )
            }
            Self::Syntax { message, .. } => write!(f, "not valid TOML: {message}"),
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
