use std::borrow::Cow;
use std::fmt;

use super::Decimal;
use super::encoding::{Encoding, to_line_feeds};
use super::error::{Excerpt, Located, Place};
use super::number::{Evidence, evidence};
use super::problem::Problem;
use super::record::BYTE_ORDER_MARK;

/// Column separator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// Tabulator.
    Tab,
}

impl Delimiter {
    /// All delimiters, in the order in which they are tried: a comma may be a decimal separator.
    pub const ALL: [Self; 3] = [Self::Tab, Self::Semicolon, Self::Comma];

    /// Returns the delimiter's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Comma => "comma",
            Self::Semicolon => "semicolon",
            Self::Tab => "tab",
        }
    }

    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
        }
    }
}

/// Dialect of a CSV file, detected by the reader or given by a mapping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    /// Column separator.
    pub delimiter: Delimiter,
    /// Decimal separator.
    pub decimal: Decimal,
    /// Whether the first record names the columns.
    pub header: bool,
    /// Whether a row of units follows the header.
    pub units_row: bool,
    /// Encoding of the text.
    pub encoding: Encoding,
    /// Whether each line ends with a carriage return alone.
    pub carriage_returns: bool,
    /// Whether the file begins with the UTF-8 byte order mark.
    pub byte_order_mark: bool,
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let decimal = match self.decimal {
            Decimal::Point => "point",
            Decimal::Comma => "comma",
        };
        write!(
            f,
            "separated by {}, decimal {decimal}",
            self.delimiter.name()
        )?;
        f.write_str(if self.header {
            ", header"
        } else {
            ", no header"
        })?;
        if self.units_row {
            f.write_str(", units row")?;
        }
        if self.byte_order_mark {
            f.write_str(", byte order mark")?;
        }
        if self.carriage_returns {
            f.write_str(", lines end with carriage returns")?;
        }
        if self.encoding != Encoding::Utf8 {
            write!(f, ", {}", self.encoding)?;
        }
        Ok(())
    }
}

/// Text of the head of a file.
pub(super) struct HeadText<'a> {
    pub(super) encoding: Encoding,
    /// Whether each line ends with a carriage return alone.
    pub(super) carriage_returns: bool,
    /// Head as UTF-8 with line feeds.
    pub(super) text: Cow<'a, [u8]>,
}

/// Returns the text of a head; refuses one that is no text.
pub(super) fn check_encoding(head: &[u8]) -> Result<HeadText<'_>, Located> {
    let refused = |guess| {
        let problem = Problem::Encoding {
            guess,
            is_text: false,
        };
        Err((Place::default(), problem))
    };
    match head {
        [] => return Err((Place::default(), Problem::Empty)),
        [b'P', b'K', 3, 4, ..] => return refused("a ZIP archive, such as an Excel workbook"),
        [b'M', b'D', b'F', b' ', ..] => return refused("an MDF measurement file"),
        _ => {}
    }
    let encoding = Encoding::of_head(head);
    let text = encoding.decoded(head);
    let Some((_, before)) = text.split_last() else {
        return Err((Place::default(), Problem::Empty));
    };
    if text.contains(&0) {
        return refused("binary data (a zero byte)");
    }
    // The line feed of a carriage return at the end may be beyond the head.
    let carriage_returns = memchr::memchr(b'\n', &text).is_none() && before.contains(&b'\r');
    let text = match carriage_returns {
        true => {
            let mut text = text.into_owned();
            to_line_feeds(&mut text);
            Cow::Owned(text)
        }
        false => text,
    };
    Ok(HeadText {
        encoding,
        carriage_returns,
        text,
    })
}

/// Returns the delimiter: the first of tab, semicolon and comma that occurs outside quotes in the first record.
pub(super) fn find_delimiter(head: &[u8], skipped_lines: u32) -> Result<Delimiter, Located> {
    let text = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head);
    let lines = text
        .split_inclusive(|&byte| byte == b'\n')
        .enumerate()
        .skip(skipped_lines as usize);
    let mut offset = None;
    for (index, line) in lines {
        if !matches!(line.first(), None | Some(b'#' | b'\n' | b'\r')) {
            offset = Some((index, line.as_ptr() as usize - text.as_ptr() as usize));
            break;
        }
    }
    let Some((line_index, offset)) = offset else {
        return Err((Place::default(), Problem::Empty));
    };
    let (mut quoted, mut seen) = (false, [false; 3]);
    let record = &text[offset..];
    for &byte in record {
        quoted ^= byte == b'"';
        if byte == b'\n' && !quoted {
            break;
        }
        for (seen, delimiter) in seen.iter_mut().zip(Delimiter::ALL) {
            *seen |= !quoted && byte == delimiter.byte();
        }
    }
    let first_line = record
        .split(|&byte| matches!(byte, b'\n' | b'\r'))
        .next()
        .unwrap_or(record);
    Delimiter::ALL
        .into_iter()
        .zip(seen)
        .find_map(|(delimiter, seen)| seen.then_some(delimiter))
        .ok_or_else(|| {
            (
                Place::line(line_index as u64 + 1),
                Problem::NoDelimiter {
                    found: Excerpt::of_bytes(first_line),
                },
            )
        })
}

/// Collected evidence of the decimal separator from the numbers in the head of a file.
#[derive(Debug, Default)]
pub(super) struct DecimalVote {
    point: Option<Ballot>,
    comma: Option<Ballot>,
    open: Option<Ballot>,
    grouped: Option<Ballot>,
}

/// First field that is evidence for one separator.
#[derive(Debug)]
pub(super) struct Ballot {
    pub(super) line: u64,
    pub(super) field: usize,
    found: Excerpt,
}

impl DecimalVote {
    pub(super) fn add(&mut self, line: u64, field: usize, cell: &str) {
        let opinion = match evidence(cell) {
            Evidence::None => return,
            Evidence::Point => &mut self.point,
            Evidence::Comma => &mut self.comma,
            Evidence::CommaOrGroup => &mut self.open,
            Evidence::Grouped => &mut self.grouped,
        };
        opinion.get_or_insert_with(|| Ballot {
            line,
            field,
            found: Excerpt::of(cell),
        });
    }

    /// Returns the separator of the whole head, or the field that contradicts it.
    pub(super) fn result(self) -> Result<Decimal, (Ballot, Problem)> {
        let with = |ballot: Ballot, problem: fn(Excerpt) -> Problem| {
            let problem = problem(ballot.found.clone());
            Err((ballot, problem))
        };
        match (self.grouped, self.point, self.comma, self.open) {
            (Some(grouped), ..) => with(grouped, |found| Problem::Thousands { found }),
            (None, Some(point), Some(comma), _) => {
                let later = if (point.line, point.field) > (comma.line, comma.field) {
                    point
                } else {
                    comma
                };
                with(later, |found| Problem::DecimalMixed { found })
            }
            (None, _, None, Some(open)) => with(open, |found| Problem::DecimalAmbiguous { found }),
            (None, None, Some(_), _) => Ok(Decimal::Comma),
            (None, _, None, None) => Ok(Decimal::Point),
        }
    }
}
