//! Parts of the readers of plant files, data sheets and controller files: places in the file, keys that were probably
//! meant, and one error with all problems.

use core::fmt;
use core::ops::Range;

use recording::nearest_name;
use toml_edit::{Document, Item, Key, Table, TableLike};

/// Size beyond which a file is certainly none that a person wrote (bytes).
const BYTES_MAX: usize = 1 << 20;
/// Number of characters of a file that an error shows at most.
const SHOWN_MAX: usize = 80;

/// TOML file whose parts have a place in the text.
#[derive(Debug)]
pub struct TomlFile<'a> {
    text: &'a str,
    document: Document<&'a str>,
}

/// Reason why a text is no TOML file.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Unreadable {
    /// The file is too large.
    #[error("{bytes} bytes, more than the {BYTES_MAX} of any such file; is it another file?")]
    TooLarge {
        /// Size of the file.
        bytes: usize,
    },
    /// The text is not TOML.
    #[error("not valid TOML: {message}")]
    Syntax {
        /// Line of the mistake, from 1.
        line: usize,
        /// Mistake, in the words of the parser.
        message: String,
    },
}

impl Unreadable {
    /// Returns the line, from 1; `None` if the whole file is meant.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::TooLarge { .. } => None,
            Self::Syntax { line, .. } => Some(*line),
        }
    }
}

impl<'a> TomlFile<'a> {
    /// Parses a text.
    ///
    /// # Errors
    /// Returns an error if the text is too large, or is not TOML.
    pub fn parse(text: &'a str) -> Result<Self, Unreadable> {
        if text.len() > BYTES_MAX {
            return Err(Unreadable::TooLarge { bytes: text.len() });
        }
        match Document::parse(text) {
            Ok(document) => Ok(Self { text, document }),
            Err(error) => Err(Unreadable::Syntax {
                line: line_of(text, error.span()),
                message: error.message().trim().replace('\n', ", "),
            }),
        }
    }

    /// Returns the tables and keys of the file.
    pub fn root(&self) -> &Table {
        self.document.as_table()
    }

    /// Returns the line of a value, from 1.
    pub fn line(&self, item: &Item) -> usize {
        line_of(self.text, item.span())
    }

    /// Returns the line of a key in its table, from 1.
    pub fn line_of_key(&self, table: &dyn TableLike, key: &str) -> usize {
        line_of(self.text, table.key(key).and_then(Key::span))
    }

    /// Returns the text of a value.
    pub fn source(&self, item: &Item) -> &'a str {
        item.span()
            .and_then(|span| self.text.get(span))
            .unwrap_or_default()
    }

    /// Returns the comment after a value on its line.
    pub fn comment_behind(&self, item: &Item) -> Option<&'a str> {
        let rest = self.text.get(item.span()?.end..)?.lines().next()?;
        let comment = rest.trim_start().strip_prefix('#')?.trim();
        (!comment.is_empty()).then_some(comment)
    }
}

fn line_of(text: &str, span: Option<Range<usize>>) -> usize {
    let end = span.map_or(0, |span| span.start.min(text.len()));
    let before = &text.as_bytes()[..end];
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

/// Returns text of a file in a form that an error may show: short, and without characters that change the display of a
/// terminal.
pub fn shown(text: &str) -> String {
    let is_plain =
        |c: char| !c.is_control() && !('\u{200b}'..='\u{206f}').contains(&c) && c != '\u{feff}';
    text.chars()
        .take(SHOWN_MAX)
        .map(|c| if is_plain(c) { c } else { '\u{fffd}' })
        .collect()
}

/// Returns a number with few digits.
pub(crate) fn brief(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e6).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// Returns the key that `word` probably means: one that begins with it, otherwise the nearest, otherwise the one that has
/// most of its words.
pub fn key_meant<'a>(word: &str, keys: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    if word.is_empty() {
        return None;
    }
    let begun = keys.clone().find(|key| key.starts_with(word));
    begun
        .or_else(|| nearest_name(word, keys.clone()))
        .or_else(|| {
            let words = word.split('_').count();
            let shared = |key: &str| {
                let own = || key.split('_');
                word.split('_')
                    .filter(|word| own().any(|one| one == *word))
                    .count()
            };
            keys.max_by_key(|key| shared(key))
                .filter(|key| 2 * shared(key) > words)
        })
}

/// Problem of a file.
pub trait FileProblem: fmt::Display {
    /// Returns the line in the file, from 1; `None` if the problem has no line.
    fn line(&self) -> Option<usize>;
}

/// All problems of one file.
#[derive(Clone, Debug)]
pub struct FileError<P> {
    file: String,
    problems: Vec<P>,
}

impl<P: FileProblem> FileError<P> {
    /// Creates the error of a file; the problems come in the order of their lines, those without a line last.
    pub fn new(file: &str, mut problems: Vec<P>) -> Self {
        problems.sort_by_key(|problem| problem.line().unwrap_or(usize::MAX));
        Self {
            file: file.to_owned(),
            problems,
        }
    }
}

impl<P> FileError<P> {
    /// Returns the problems, in the order of the file.
    pub fn problems(&self) -> &[P] {
        &self.problems
    }
}

impl<P: FileProblem + fmt::Debug> core::error::Error for FileError<P> {}

impl<P: FileProblem> fmt::Display for FileError<P> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_key_and_value_has_its_line_and_its_comment() {
        let file = TomlFile::parse("# first\n[a]\nx = 1.5   # measured\ny = \"z\"\n").unwrap();
        let table = file.root()["a"].as_table().unwrap();
        let (x, y) = (&table["x"], &table["y"]);
        assert_eq!((file.line_of_key(table, "x"), file.line(y)), (3, 4));
        assert_eq!((file.source(x), file.source(y)), ("1.5", "\"z\""));
        assert_eq!(file.comment_behind(x), Some("measured"));
        assert_eq!(file.comment_behind(y), None);
    }

    #[test]
    fn a_text_that_is_no_toml_or_too_large_is_refused_with_its_reason() {
        let wrong = TomlFile::parse("a = 1\nb = \n").unwrap_err();
        assert_eq!(wrong.line(), Some(2));
        assert!(wrong.to_string().starts_with("not valid TOML: "), "{wrong}");
        let large = "#".repeat(BYTES_MAX + 1);
        let wrong = TomlFile::parse(&large).unwrap_err();
        assert_eq!(wrong.line(), None);
        assert!(wrong.to_string().contains("1048577 bytes"), "{wrong}");
    }

    #[test]
    fn a_key_is_meant_by_its_beginning_a_slip_or_most_of_its_words() {
        let keys = || {
            [
                "fill_with_supply_pressure_pct",
                "gain_pct_per_bar",
                "max_pct",
            ]
            .into_iter()
        };
        for (word, meant) in [
            ("gain", Some("gain_pct_per_bar")),
            ("gain_pct_per_baar", Some("gain_pct_per_bar")),
            ("pressure_fill_bar", Some("fill_with_supply_pressure_pct")),
            ("pressure_bar", None),
            ("", None),
        ] {
            assert_eq!(key_meant(word, keys()), meant, "{word}");
        }
    }

    #[test]
    fn text_that_is_shown_is_short_and_changes_no_terminal() {
        assert_eq!(shown("a\u{1b}[31m\u{202e}b"), "a\u{fffd}[31m\u{fffd}b");
        assert_eq!(shown(&"x".repeat(1000)).len(), SHOWN_MAX);
    }
}
