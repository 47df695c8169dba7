//! First rows of a log: as signals if it can be read, otherwise as text.

use std::borrow::Cow;
use std::io::{BufRead, BufReader, Cursor, Read as _};
use std::path::Path;

use recording::csv::{Delimiter, Encoding};
use recording::{InspectedLog, PressureReference, Recording, Unit};
use serde::Serialize;

use crate::log_reader;
use crate::refusal::Refusal;
use crate::session::Session;
use crate::store::open_regular;

/// Number of rows.
const ROWS: usize = 12;
/// Lines that are shown before and after a wrong line.
const AROUND: u64 = 2;
/// Maximum number of bytes that are shown of a line.
const LINE_BYTES_MAX: u64 = 4096;
/// Number of bytes that show the encoding of a file.
const HEAD_BYTES: u64 = 64 << 10;
/// Maximum number of channels that distinguish kinds of files.
const CHANNELS_MAX: usize = 500;
/// Maximum number of cells that are shown of a line.
const CELLS_MAX: usize = 64;

#[derive(Serialize)]
pub(in crate::pages) struct Preview {
    /// Columns of the file with a guess of each; `None` if it is no log at all.
    inspection: Option<InspectedLog>,
    /// Rows of values, with the time first; empty if the log cannot be read.
    columns: Vec<ColumnView>,
    rows: Vec<Vec<Option<f64>>>,
    /// Text of the file's head; empty for a binary file.
    head: Text,
    /// Text around the wrong line.
    around: Option<Text>,
    /// Mapping in use, TOML.
    mapping: Option<String>,
    /// Signals of the model with their units.
    known: Vec<Known>,
    /// Tokens of all units, in the notation of a mapping.
    units: Vec<&'static str>,
}

#[derive(Serialize)]
struct ColumnView {
    name: String,
    unit: String,
}

#[derive(Serialize)]
struct Text {
    delimiter: &'static str,
    lines: Vec<Line>,
}

#[derive(Serialize)]
struct Line {
    /// Number of the line, from 1.
    number: u64,
    cells: Vec<String>,
}

#[derive(Serialize)]
struct Known {
    name: &'static str,
    unit: &'static str,
}

impl Preview {
    /// Creates the preview of a log; `reference` is that of pressures whose unit states none.
    pub(in crate::pages) fn of(
        session: &Session,
        number: u32,
        reference: Option<PressureReference>,
    ) -> Result<Self, Refusal> {
        let project = session.project();
        let entry = project.log(number)?;
        let path = session.store.log_path(&entry.file);
        let log = session.log(number)?;
        let head = match log_reader::is_csv(&path) {
            true => lines(&path, 1, ROWS as u64)?,
            false => Vec::new(),
        };
        let delimiter = delimiter(&head);
        let (columns, rows) = log
            .as_ref()
            .as_ref()
            .map(|log| values(&log.recording))
            .unwrap_or_default();
        let wrong_line = log.as_ref().as_ref().err().and_then(|problem| problem.line);
        let around = match wrong_line.filter(|&line| line > ROWS as u64) {
            Some(line) => {
                let lines = lines(&path, line.saturating_sub(AROUND), 2 * AROUND + 1)?;
                Some(text(lines, delimiter))
            }
            None => None,
        };
        let inspection =
            log_reader::inspect(&entry.name, &path, entry.mapping.as_deref(), reference);
        Ok(Self {
            inspection: inspection.ok(),
            columns,
            rows,
            head: text(head, delimiter),
            around,
            mapping: entry.mapping.clone(),
            known: plant_sim::replay::ROW_SIGNALS
                .iter()
                .map(|(name, unit)| Known {
                    name,
                    unit: unit.token(),
                })
                .collect(),
            units: Unit::all().map(Unit::token).collect(),
        })
    }
}

/// Returns the first rows of the first time base.
fn values(log: &Recording) -> (Vec<ColumnView>, Vec<Vec<Option<f64>>>) {
    let Some((id, base)) = log.time_bases().next() else {
        return Default::default();
    };
    let signals = || {
        log.signals()
            .iter()
            .filter(|signal| signal.time_base() == id)
    };
    let time = ColumnView {
        name: "time".to_owned(),
        unit: "s".to_owned(),
    };
    let others = signals().map(|signal| ColumnView {
        name: signal.name().to_owned(),
        unit: signal.unit().symbol().to_owned(),
    });
    let rows = (0..base.len().min(ROWS)).map(|row| {
        let time_s = Some(base.times_s()[row]);
        std::iter::once(time_s)
            .chain(signals().map(|signal| signal.get(row)))
            .collect()
    });
    (
        std::iter::once(time).chain(others).collect(),
        rows.collect(),
    )
}

/// Returns the first line or the names of the channels, which distinguish kinds of files.
pub(in crate::pages) fn head_key(path: &Path) -> Option<String> {
    if !log_reader::is_csv(path) {
        let inspection = log_reader::inspect("log", path, None, None).ok()?;
        let channels = inspection.columns.into_iter().take(CHANNELS_MAX);
        let names: Vec<String> = channels.map(|channel| channel.key).collect();
        return Some(names.join("\n"));
    }
    let first = lines(path, 1, 1).ok()?.pop()?.1;
    // Without a header, the first line is data, and the number of columns has to suffice.
    let separator = delimiter(&[(1, first.clone())]);
    let cells = first.split(symbol(separator));
    if first.chars().any(char::is_alphabetic) {
        Some(first)
    } else {
        Some(format!("{} columns without header", cells.count()))
    }
}

/// Returns the first bytes of a file.
fn head(path: &Path) -> Result<Vec<u8>, Refusal> {
    let mut head = Vec::new();
    let file = open_regular(path)?;
    file.take(HEAD_BYTES).read_to_end(&mut head)?;
    Ok(head)
}

/// Returns `count` lines from line `from` on, with their numbers; bytes that are not text are replaced.
fn lines(path: &Path, from: u64, count: u64) -> Result<Vec<(u64, String)>, Refusal> {
    let head = head(path)?;
    let encoding = Encoding::of_head(&head);
    let from = from.max(1);
    // A line feed of UTF-16 is no single byte: its preview ends with the head.
    let mut file: Box<dyn BufRead> = match encoding {
        Encoding::Utf8 | Encoding::Windows1252 => Box::new(BufReader::new(open_regular(path)?)),
        _ => Box::new(Cursor::new(encoding.decoded(&head).into_owned())),
    };
    let mut found = Vec::new();
    for number in 1..from + count {
        let mut bytes = Vec::new();
        if (&mut file)
            .take(LINE_BYTES_MAX)
            .read_until(b'\n', &mut bytes)?
            == 0
        {
            break;
        }
        let is_cut = bytes.last() != Some(&b'\n') && bytes.len() as u64 == LINE_BYTES_MAX;
        if is_cut {
            file.skip_until(b'\n')?;
        }
        if number >= from {
            let bytes = match encoding {
                Encoding::Windows1252 => encoding.decoded(&bytes),
                _ => Cow::Borrowed(&*bytes),
            };
            let text = String::from_utf8_lossy(&bytes);
            let text = text
                .trim_start_matches('\u{feff}')
                .trim_end_matches(['\r', '\n']);
            found.push((number, text.to_owned()));
        }
    }
    Ok(found)
}

/// Returns the separator with the same count in every line; among several, or without one, the most frequent.
fn delimiter(lines: &[(u64, String)]) -> Delimiter {
    let judged = |delimiter: &Delimiter| {
        let counts = lines
            .iter()
            .map(|(_, line)| line.matches(symbol(*delimiter)).count());
        let counts: Vec<usize> = counts.collect();
        let is_even = counts.windows(2).all(|pair| pair[0] == pair[1]);
        let sum: usize = counts.iter().sum();
        (is_even && sum > 0, sum)
    };
    // The last of equal counts is chosen, and a comma may be a decimal comma, so it comes first.
    [Delimiter::Comma, Delimiter::Tab, Delimiter::Semicolon]
        .into_iter()
        .max_by_key(judged)
        .unwrap_or(Delimiter::Comma)
}

fn symbol(delimiter: Delimiter) -> char {
    match delimiter {
        Delimiter::Comma => ',',
        Delimiter::Semicolon => ';',
        Delimiter::Tab => '\t',
    }
}

fn text(lines: Vec<(u64, String)>, delimiter: Delimiter) -> Text {
    let cells = |line: String| {
        line.split(symbol(delimiter))
            .take(CELLS_MAX)
            .map(|cell| cell.trim().trim_matches('"').to_owned())
            .collect()
    };
    Text {
        delimiter: match delimiter {
            Delimiter::Comma => "comma",
            Delimiter::Semicolon => "semicolon",
            Delimiter::Tab => "tab",
        },
        lines: lines
            .into_iter()
            .map(|(number, line)| Line {
                number,
                cells: cells(line),
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbered_cut_and_found_behind_long_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let long = "x".repeat(10_000);
        std::fs::write(&path, format!("\u{feff}a;b\r\n{long}\n1;2\n")).unwrap();
        let found = lines(&path, 1, 9).unwrap();
        assert_eq!(found[0], (1, "a;b".to_owned()));
        assert_eq!(found[1].1.len() as u64, LINE_BYTES_MAX);
        assert_eq!(found[2], (3, "1;2".to_owned()));
        assert_eq!(lines(&path, 3, 9).unwrap(), found[2..]);
    }

    /// Defect seen: `Prüfstand` was shown as `Pr\u{fffd}fstand` beside the columns, which were read in their encoding.
    #[test]
    fn lines_are_shown_in_the_encoding_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let text = "Prüfstand;7\r\nZeit;Füllventil\r\n";
        let one_byte = |c: char| u8::try_from(c as u32).unwrap();
        let latin: Vec<u8> = text.chars().map(one_byte).collect();
        let wide: Vec<u8> = ("\u{feff}".to_owned() + text)
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        for bytes in [text.as_bytes().to_vec(), latin, wide] {
            std::fs::write(&path, bytes).unwrap();
            let found = lines(&path, 2, 9).unwrap();
            assert_eq!(found, [(2, "Zeit;Füllventil".to_owned())]);
        }
    }

    #[test]
    fn a_decimal_comma_is_no_separator() {
        let found = |text: &str| {
            let lines: Vec<_> = (1..).zip(text.lines().map(str::to_owned)).collect();
            delimiter(&lines)
        };
        assert_eq!(found("0;1,5\n0,5;1,6\n1;1,7"), Delimiter::Semicolon);
        assert_eq!(found("t,p\n0.5,1\n1.5,2"), Delimiter::Comma);
        assert_eq!(found("t\tp\n0,5\t1\n1\t2"), Delimiter::Tab);
    }

    #[test]
    fn files_are_distinguished_by_their_header_or_by_their_width() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let key = |text: &str| {
            std::fs::write(&path, text).unwrap();
            head_key(&path)
        };
        assert_eq!(key("t;p\n1;2\n").unwrap(), "t;p");
        assert_eq!(key("1,5;2\n3,5;4\n").unwrap(), "2 columns without header");
        assert_eq!(key(""), None);
    }
}
