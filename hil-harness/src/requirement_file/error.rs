//! Problems of a requirements file, and how to correct them.

use core::fmt;

use super::keys::{KEYS, Key, Kind, tables};

/// All problems of one requirements file.
#[derive(Clone, Debug)]
pub struct RequirementFileError {
    file: String,
    problems: Vec<Problem>,
}

/// One problem; lines count from 1.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the variants' sentences name the fields")]
#[non_exhaustive]
pub enum Problem {
    /// The file is not TOML.
    Syntax { line: usize, message: String },
    /// The table does not exist, or a key stands outside of the tables.
    UnknownTable { line: usize, table: String },
    /// The key does not exist in its table.
    UnknownKey {
        line: usize,
        table: String,
        key: String,
    },
    /// The value is neither a number nor a word of its key.
    WrongValue {
        line: usize,
        key: &'static Key,
        found: String,
    },
    /// The number is out of range.
    OutOfRange {
        line: usize,
        key: &'static Key,
        found: f64,
    },
    /// The lower of two values is not below the upper one.
    NotBelow {
        line: usize,
        lower: &'static str,
        upper: &'static str,
        found: [f64; 2],
    },
}

impl RequirementFileError {
    pub(super) fn new(file: &str, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(Problem::line);
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
    /// Returns the line in the file, from 1.
    pub fn line(&self) -> usize {
        match self {
            Self::Syntax { line, .. }
            | Self::UnknownTable { line, .. }
            | Self::UnknownKey { line, .. }
            | Self::WrongValue { line, .. }
            | Self::OutOfRange { line, .. }
            | Self::NotBelow { line, .. } => *line,
        }
    }
}

impl core::error::Error for RequirementFileError {}

impl fmt::Display for RequirementFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, problem) in self.problems.iter().enumerate() {
            if n > 0 {
                writeln!(f)?;
            }
            write!(f, "{}:{}: {problem}", self.file, problem.line())?;
        }
        Ok(())
    }
}

/// Returns the allowed values of a key, in words.
fn allowed(key: &Key) -> String {
    match key.kind {
        Kind::Number(min, max) => format!("a number from {min} to {max}"),
        Kind::Whole(min, max) => format!("a whole number from {min} to {max}"),
        Kind::Word(words) => {
            let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
            words.join(" or ")
        }
        Kind::Flag => "true or false".to_owned(),
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax { message, .. } => write!(f, "not valid TOML: {message}"),
            Self::UnknownTable { table, .. } => {
                let known: Vec<String> =
                    tables().iter().map(|table| format!("[{table}]")).collect();
                write!(
                    f,
                    "unknown table [{table}]; a requirements file has the tables {}",
                    known.join(", ")
                )
            }
            Self::UnknownKey { table, key, .. } => {
                let of_table = KEYS.iter().filter(|known| known.table == table);
                let known: Vec<&str> = of_table.map(|known| known.name).collect();
                write!(
                    f,
                    "unknown key `{table}.{key}`; [{table}] has the keys {}",
                    known.join(", ")
                )
            }
            Self::WrongValue { key, found, .. } => write!(
                f,
                "`{}` = {found}; write {} ({})",
                key.path(),
                allowed(key),
                key.about
            ),
            Self::OutOfRange { key, found, .. } => write!(
                f,
                "`{}` = {found} is out of range; write {} ({})",
                key.path(),
                allowed(key),
                key.about
            ),
            Self::NotBelow {
                lower,
                upper,
                found: [low, high],
                ..
            } => write!(
                f,
                "`{lower}` = {low} is not below `{upper}` = {high}; change one of them"
            ),
        }
    }
}
