use std::fmt;

use super::Problem;
use crate::name::is_unprintable;

/// Refusal of a CSV file: reason and place.
///
/// Its text is one line: code, place, found value, expected value, next step.
#[derive(Debug)]
pub struct CsvError(Box<Details>);

#[derive(Debug)]
struct Details {
    source_name: String,
    place: Place,
    problem: Problem,
}

/// Place in a CSV file, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: Option<u64>,
    /// Column, from 1.
    pub column: Option<usize>,
    /// Header field of the column.
    pub header: Option<Excerpt>,
}

/// Problem with its place, as returned by the parts of the reader before the file is named.
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

/// Text found in a file, made safe for a terminal: escaped, and cut to [`Excerpt::CHARACTERS_MAX`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Excerpt(String);

impl Excerpt {
    /// Maximum length of an excerpt (characters).
    pub const CHARACTERS_MAX: usize = 80;

    /// Creates an excerpt from the beginning of `text`.
    pub fn of(text: &str) -> Self {
        let mut excerpt = String::new();
        let mut count = 0;
        for character in text.chars() {
            let is_escaped = is_unprintable(character) || matches!(character, '"' | '\\');
            let length = if is_escaped {
                character.escape_default().len()
            } else {
                1
            };
            // The last place is reserved for the mark of a cut.
            if count + length >= Self::CHARACTERS_MAX {
                excerpt.push('…');
                break;
            }
            count += length;
            if is_escaped {
                excerpt.extend(character.escape_default());
            } else {
                excerpt.push(character);
            }
        }
        Self(excerpt)
    }

    /// Creates an excerpt from the beginning of `bytes`; bytes that are not UTF-8 are replaced.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self::of(&String::from_utf8_lossy(
            &bytes[..bytes.len().min(4 * Self::CHARACTERS_MAX)],
        ))
    }

    /// Returns the escaped text.
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
    pub(crate) fn new(source_name: &str, place: Place, problem: Problem) -> Self {
        Self(Box::new(Details {
            source_name: source_name.to_owned(),
            place,
            problem,
        }))
    }

    /// Creates the error of a file `source_name` that cannot be read at all.
    pub(crate) fn io(source_name: &str, error: std::io::Error) -> Self {
        Self::new(source_name, Place::default(), Problem::Io(error))
    }

    /// Returns the stable code, such as `E-CSV-TIME-ORDER`.
    pub fn code(&self) -> &'static str {
        self.problem().code()
    }

    /// Returns the name of the file, as given to its reader.
    pub fn source_name(&self) -> &str {
        &self.0.source_name
    }

    /// Returns the place in the file.
    pub fn place(&self) -> &Place {
        &self.0.place
    }

    /// Returns the problem.
    pub fn problem(&self) -> &Problem {
        &self.0.problem
    }

    /// Returns whether the problem concerns one row, which [`Limits::bad_rows`](super::Limits::bad_rows) can skip.
    pub fn is_of_row(&self) -> bool {
        self.problem().is_of_row()
    }

    /// Returns whether a budget was exceeded, which the caller may raise.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_excerpt_is_printable_and_at_most_80_characters_long() {
        let exact = "a".repeat(Excerpt::CHARACTERS_MAX - 1);
        assert_eq!(Excerpt::of(&exact).as_str(), exact);
        let long = [
            "a".repeat(81),
            "\u{1b}".repeat(50),
            "ä".repeat(200),
            "\"".repeat(79),
        ];
        for text in long {
            let excerpt = Excerpt::of(&text);
            let count = excerpt.as_str().chars().count();
            assert!(
                (70..=Excerpt::CHARACTERS_MAX).contains(&count),
                "{count}: {excerpt}"
            );
            assert!(excerpt.as_str().ends_with('…'), "{excerpt}");
        }
        assert_eq!(
            Excerpt::of("a\u{1b}[31m\n\u{202e}\"").as_str(),
            "a\\u{1b}[31m\\n\\u{202e}\\\""
        );
        assert_eq!(Excerpt::of_bytes(b"\xff1").as_str(), "\u{fffd}1");
    }
}
