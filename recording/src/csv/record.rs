//! Splitting of bytes into records within the budgets, with the line of each record.

use std::io::{self, Read};

use csv_core::ReadRecordResult;
use sha2::{Digest, Sha256};

use super::encoding::{Decoding, Encoding};
use super::error::{Located, Place};
use super::problem::{Budget, Problem};
use super::{Delimiter, Limits};
use crate::{InputFile, Note};

pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
const CHUNK_BYTES: usize = 64 << 10;
/// Initial size for the fields of a record, and maximum length of a record that is read without the state machine
/// (bytes).
const PLAIN_BYTES: usize = 1024;
const NOTES_MAX: usize = 256;
const NOTE_BYTES_MAX: usize = 1024;

/// Reader of the records of an input; the budgets bound its memory for any input.
pub(super) struct Records<R> {
    input: R,
    decoding: Decoding,
    limits: Limits,
    delimiter: u8,
    core: csv_core::Reader,
    chunk: Vec<u8>,
    position: usize,
    filled: usize,
    at_end: bool,
    line: u64,
    size_bytes: u64,
    hash: Sha256,
    fields: Vec<u8>,
    ends: Vec<usize>,
    record: RecordMeta,
    notes: Vec<Note>,
}

#[derive(Clone, Copy, Default)]
struct RecordMeta {
    line: u64,
    bytes: usize,
    ends: usize,
    at_end_of_file: bool,
}

/// One record: its fields, its line, and whether the file ended with it.
#[derive(Clone, Copy)]
pub(super) struct Record<'a> {
    text: &'a str,
    ends: &'a [usize],
    pub(super) line: u64,
    /// Whether no line feed came after this record.
    pub(super) at_end_of_file: bool,
}

impl<'a> Record<'a> {
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns field `index` without outer spaces; empty if the field does not exist.
    pub(super) fn get(&self, index: usize) -> &'a str {
        let Some(&end) = self.ends.get(index) else {
            return "";
        };
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        self.text.get(start..end).unwrap_or("").trim_matches(' ')
    }

    pub(super) fn iter(self) -> impl Iterator<Item = &'a str> {
        (0..self.len()).map(move |index| self.get(index))
    }
}

impl<R: Read> Records<R> {
    pub(super) fn new(input: R, encoding: Encoding, delimiter: Delimiter, limits: Limits) -> Self {
        Self {
            input,
            decoding: Decoding::new(encoding),
            limits,
            delimiter: delimiter.byte(),
            core: csv_core::ReaderBuilder::new()
                .delimiter(delimiter.byte())
                .build(),
            chunk: vec![0; CHUNK_BYTES],
            position: 0,
            filled: 0,
            at_end: false,
            line: 1,
            size_bytes: 0,
            hash: Sha256::new(),
            fields: vec![0; PLAIN_BYTES],
            ends: vec![0; 16],
            record: RecordMeta::default(),
            notes: Vec::new(),
        }
    }

    /// Takes carriage returns as line feeds, if `carriage_returns` is set.
    pub(super) fn with_carriage_returns(mut self, carriage_returns: bool) -> Self {
        self.decoding.carriage_returns = carriage_returns;
        self
    }

    /// Returns the next record, skipping blank lines and comments; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<Record<'_>>, Located> {
        if !self.advance()? {
            return Ok(None);
        }
        self.current().map(Some)
    }

    /// Returns the record that [`Records::next`] returned last.
    pub(super) fn current(&self) -> Result<Record<'_>, Located> {
        let RecordMeta {
            line,
            bytes,
            ends,
            at_end_of_file,
        } = self.record;
        let text = std::str::from_utf8(&self.fields[..bytes]).map_err(|_| {
            (
                Place::line(line),
                Problem::Encoding {
                    guess: "bytes of an 8-bit encoding such as Windows-1252",
                    is_text: true,
                },
            )
        })?;
        Ok(Record {
            text,
            ends: &self.ends[..ends],
            line,
            at_end_of_file,
        })
    }

    /// Skips `lines` lines with any content, then `records` records.
    pub(super) fn skip(&mut self, lines: u32, records: usize) -> Result<(), Located> {
        for _ in 0..lines {
            if !self.skip_line(None)? {
                break;
            }
        }
        for _ in 0..records {
            self.next()?;
        }
        Ok(())
    }

    /// Takes the `# key: value` lines before the first record.
    pub(super) fn take_notes(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.notes)
    }

    /// Returns size and hash of the data read so far.
    pub(super) fn input_file(&self) -> InputFile {
        InputFile {
            size_bytes: self.size_bytes,
            sha256: self.hash.clone().finalize().into(),
        }
    }

    /// Reads the next record if it lies completely in the chunk, has neither quotes nor unusual line ends, and meets
    /// all budgets. Nearly every record of a log does. All others are left to the state machine, which is slower.
    fn advance_plain(&mut self) -> bool {
        let rest = &self.chunk[self.position..self.filled];
        let Some(line_feed) = memchr::memchr(b'\n', &rest[..rest.len().min(PLAIN_BYTES)]) else {
            return false;
        };
        let record = &rest[..line_feed];
        let record = record.strip_suffix(b"\r").unwrap_or(record);
        let (mut bytes, mut ends) = (0, 0);
        for &byte in record {
            if byte == self.delimiter {
                let Some(end) = self.ends.get_mut(ends) else {
                    return false;
                };
                (*end, ends) = (bytes, ends + 1);
            } else if matches!(byte, b'"' | b'\r') {
                return false;
            } else {
                self.fields[bytes] = byte;
                bytes += 1;
            }
        }
        let Some(end) = self.ends.get_mut(ends) else {
            return false;
        };
        (*end, ends) = (bytes, ends + 1);
        let Limits {
            columns,
            field_bytes,
            record_bytes,
            ..
        } = self.limits;
        if ends > columns || record.len() > field_bytes || record.len() >= record_bytes {
            return false;
        }
        self.record = RecordMeta {
            line: self.line,
            bytes,
            ends,
            at_end_of_file: false,
        };
        self.position += line_feed + 1;
        self.line += 1;
        true
    }

    fn advance(&mut self) -> Result<bool, Located> {
        if !self.skip_to_record()? {
            return Ok(false);
        }
        if self.advance_plain() {
            return Ok(true);
        }
        let line = self.line;
        let at = |problem| (Place::line(line), problem);
        let over = |budget, bound: usize| {
            at(Problem::Limit {
                budget,
                bound: bound as u64,
            })
        };
        let (mut consumed, mut bytes, mut ends, mut field_start) = (0, 0, 0, 0);
        loop {
            let input = &self.chunk[self.position..self.filled];
            let (result, read, written, ended) =
                self.core
                    .read_record(input, &mut self.fields[bytes..], &mut self.ends[ends..]);
            self.line += memchr::memchr_iter(b'\n', &input[..read]).count() as u64;
            self.position += read;
            consumed += read;
            bytes += written;
            for &end in &self.ends[ends..ends + ended] {
                if end - field_start > self.limits.field_bytes {
                    return Err(over(Budget::FieldBytes, self.limits.field_bytes));
                }
                field_start = end;
            }
            ends += ended;
            if consumed > self.limits.record_bytes {
                return Err(over(Budget::RecordBytes, self.limits.record_bytes));
            }
            if bytes - field_start > self.limits.field_bytes {
                return Err(over(Budget::FieldBytes, self.limits.field_bytes));
            }
            if ends > self.limits.columns {
                return Err(over(Budget::Columns, self.limits.columns));
            }
            match result {
                ReadRecordResult::InputEmpty => {
                    self.fill()
                        .map_err(|problem| (Place::line(self.line), problem))?;
                }
                // The budgets checked above limit the growth.
                ReadRecordResult::OutputFull => self.fields.resize(self.fields.len() * 2, 0),
                ReadRecordResult::OutputEndsFull => self.ends.resize(self.ends.len() * 2, 0),
                ReadRecordResult::Record => break,
                ReadRecordResult::End => return Ok(false),
            }
        }
        // A line feed ends a record before the end of the file is known.
        let at_end_of_file = self.at_end;
        let ends_with_return = self.position > 0 && self.chunk[self.position - 1] == b'\r';
        if ends_with_return && self.peek()?.is_some_and(|next| next != b'\n') {
            return Err(at(Problem::LineEnd));
        }
        self.record = RecordMeta {
            line,
            bytes,
            ends,
            at_end_of_file,
        };
        Ok(true)
    }

    /// Moves to the first byte of a record; returns false at the end of the file.
    fn skip_to_record(&mut self) -> Result<bool, Located> {
        loop {
            let Some(byte) = self.peek()? else {
                return Ok(false);
            };
            match byte {
                b'\n' => {
                    self.line += 1;
                    self.position += 1;
                }
                b'\r' => self.position += 1,
                b'#' => {
                    let mut comment = Vec::new();
                    self.skip_line(Some(&mut comment))?;
                    self.keep_note(&comment);
                }
                _ => return Ok(true),
            }
        }
    }

    /// Skips to the next line and stores the beginning of this one in `kept`; returns false at the end of the file.
    fn skip_line(&mut self, mut kept: Option<&mut Vec<u8>>) -> Result<bool, Located> {
        while self.peek()?.is_some() {
            let rest = &self.chunk[self.position..self.filled];
            let line_feed = memchr::memchr(b'\n', rest);
            let part = &rest[..line_feed.unwrap_or(rest.len())];
            if let Some(kept) = &mut kept {
                let room = NOTE_BYTES_MAX - kept.len().min(NOTE_BYTES_MAX);
                kept.extend_from_slice(&part[..part.len().min(room)]);
            }
            self.position += part.len();
            if line_feed.is_some() {
                self.position += 1;
                self.line += 1;
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn keep_note(&mut self, comment: &[u8]) {
        let no_record_yet = self.record.line == 0;
        let text = String::from_utf8_lossy(comment);
        let text = text.trim_start_matches('#').trim();
        if !no_record_yet || text.is_empty() || self.notes.len() == NOTES_MAX {
            return;
        }
        let (key, value) = text.split_once(':').unwrap_or(("comment", text));
        self.notes.push(Note {
            key: key.trim().to_owned(),
            value: value.trim().to_owned(),
        });
    }

    fn peek(&mut self) -> Result<Option<u8>, Located> {
        if self.position == self.filled {
            self.fill()
                .map_err(|problem| (Place::line(self.line), problem))?;
        }
        Ok((self.position < self.filled).then(|| self.chunk[self.position]))
    }

    /// Replaces a used-up chunk.
    fn fill(&mut self) -> Result<(), Problem> {
        if self.at_end {
            return Ok(());
        }
        let is_first = self.size_bytes == 0;
        let (size_bytes, hash) = (&mut self.size_bytes, &mut self.hash);
        let mut see = |raw: &[u8]| {
            *size_bytes += raw.len() as u64;
            hash.update(raw);
        };
        let read = self
            .decoding
            .read(&mut self.input, &mut self.chunk, &mut see);
        let count = read.map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData => Problem::Encoding {
                guess: "a damaged character of UTF-16",
                is_text: true,
            },
            _ => Problem::Io(error),
        })?;
        if count == 0 {
            self.at_end = true;
            return Ok(());
        }
        if self.size_bytes > self.limits.file_bytes {
            return Err(Problem::Limit {
                budget: Budget::FileBytes,
                bound: self.limits.file_bytes,
            });
        }
        let mark = if is_first && self.chunk[..count].starts_with(BYTE_ORDER_MARK) {
            BYTE_ORDER_MARK.len()
        } else {
            0
        };
        (self.position, self.filled) = (mark, count);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Input that returns one byte at a time, so that no record lies completely in a chunk.
    struct Drops<'a>(&'a [u8]);

    impl Read for Drops<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let length = self.0.len().min(1);
            self.0.read(&mut buffer[..length])
        }
    }

    /// Line of a record, whether the file ends with it, and its fields.
    type Seen = (u64, bool, Vec<String>);

    /// Returns every record and the first error; which of several exceeded budgets is reported depends on the chunks.
    fn read_all(input: impl Read, limits: Limits) -> (Vec<Seen>, Option<String>) {
        let mut records = Records::new(input, Encoding::Utf8, Delimiter::Comma, limits);
        let mut seen = Vec::new();
        loop {
            match records.next() {
                Ok(Some(record)) => {
                    let fields = record.iter().map(str::to_owned).collect();
                    seen.push((record.line, record.at_end_of_file, fields));
                }
                Ok(None) => return (seen, None),
                Err((place, Problem::Limit { .. })) => {
                    return (seen, Some(format!("{place:?}: over a budget")));
                }
                Err(error) => return (seen, Some(format!("{error:?}"))),
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_short_way_through_plain_records_reads_as_the_state_machine_does(
            text in "(1|2,|\"|\"\"|,|\r|\n|\r\n|#|é| |3.5,-1\n){0,40}",
            (field_bytes, record_bytes, columns) in (1..12_usize, 1..40_usize, 1..6_usize),
        ) {
            let tight = Limits { field_bytes, record_bytes, columns, ..Limits::default() };
            for limits in [Limits::default(), tight] {
                let whole = read_all(text.as_bytes(), limits);
                prop_assert_eq!(whole, read_all(Drops(text.as_bytes()), limits));
            }
        }
    }
}
