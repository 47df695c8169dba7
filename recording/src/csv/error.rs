use std::fmt;

use super::Problem;
use crate::name::is_unprintable;

/// Why a CSV file was refused, and where.
///
/// Its text is one line: code, place, what was found, what was expected, what to do next.
#[derive(Debug)]
pub struct CsvError(Box<Details>);

#[derive(Debug)]
struct Details {
    source_name: String,
    place: Place,
    problem: Problem,
}

/// A place in a CSV file, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: Option<u64>,
    /// Column, from 1.
    pub column: Option<usize>,
    /// Text at the head of the column.
    pub header: Option<Excerpt>,
}

/// A problem and its place: what the parts of the reader return, before the file is named.
pub(super) type Located = (Place, Problem);

impl Place {
    pub(super) fn line(line: u64) -> Self {
        Self {
            line: Some(line),
            ..Self::default()
        }
    }

    pub(super) fn cell(line: u64, field: usize, header: Option<&str>) -> Self {
        Self {
            line: Some(line),
            column: Some(field + 1),
            header: header.map(Excerpt::of),
        }
    }
}

/// Text found in a file, fit for a terminal: escaped, and cut to [`Excerpt::CHARACTERS_MAX`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Excerpt(String);

impl Excerpt {
    /// Longest excerpt in characters.
    pub const CHARACTERS_MAX: usize = 80;

    /// The beginning of `text`.
    pub fn of(text: &str) -> Self {
        let mut excerpt = String::new();
        let mut count = 0;
        for character in text.chars() {
            let shown = if is_unprintable(character) || matches!(character, '"' | '\\') {
                character.escape_default().to_string()
            } else {
                character.to_string()
            };
            // The last place is kept for the mark of a cut.
            if count + shown.len() >= Self::CHARACTERS_MAX {
                excerpt.push('…');
                break;
            }
            count += if shown.len() > 1 && shown.is_ascii() {
                shown.len()
            } else {
                1
            };
            excerpt.push_str(&shown);
        }
        Self(excerpt)
    }

    /// The beginning of `bytes`, those that are not UTF-8 replaced.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self::of(&String::from_utf8_lossy(
            &bytes[..bytes.len().min(4 * Self::CHARACTERS_MAX)],
        ))
    }

    /// The escaped text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\"", self.0)
    }
}

impl CsvError {
    pub(super) fn new(source_name: &str, place: Place, problem: Problem) -> Self {
        Self(Box::new(Details {
            source_name: source_name.to_owned(),
            place,
            problem,
        }))
    }

    /// The stable code, such as `E-CSV-TIME-ORDER`.
    pub fn code(&self) -> &'static str {
        self.problem().code()
    }

    /// The file, as its reader named it.
    pub fn source_name(&self) -> &str {
        &self.0.source_name
    }

    /// Where in the file.
    pub fn place(&self) -> &Place {
        &self.0.place
    }

    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.0.problem
    }

    /// True if a budget was exceeded, which the caller may raise.
    pub fn is_limit(&self) -> bool {
        matches!(self.problem(), Problem::Limit { .. })
    }
}

impl fmt::Display for CsvError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place {
            line,
            column,
            header,
        } = self.place();
        write!(
            f,
            "{}: {}",
            self.code(),
            Excerpt::of(self.source_name()).as_str()
        )?;
        if let Some(line) = line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = column {
            write!(f, ", column {column}")?;
        }
        if let Some(header) = header {
            write!(f, " {header}")?;
        }
        write!(f, ": {}; {}", self.problem(), self.problem().next_step())
    }
}

impl std::error::Error for CsvError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self.problem() {
            Problem::Io(error) => Some(error),
            Problem::Name { problem, .. } => Some(problem),
            _ => None,
        }
    }
}
