//! Head of a file: its dialect, its header, its units.

use std::io::{self, Read};

use super::dialect::{DecimalVote, HeadText, check_encoding, find_delimiter};
use super::encoding::Encoding;
use super::error::{Excerpt, Located, Place};
use super::header::is_units_row;
use super::number;
use super::plan::{Head, Plan, resolve};
use super::problem::{Budget, Problem};
use super::record::{BYTE_ORDER_MARK, Record, Records};
use super::{Decimal, Delimiter, Dialect, Limits, Options};

/// Size of the head, which decides about the dialect (bytes).
const HEAD_BYTES: usize = 64 << 10;

/// Results from the head of a file.
pub(super) struct Opening {
    /// Bytes read from the input.
    pub(super) head: Vec<u8>,
    pub(super) dialect: Dialect,
    pub(super) plan: Plan,
    /// Number of records before the first row.
    pub(super) header_records: usize,
}

impl Opening {
    pub(super) fn read(input: &mut impl Read, options: &Options) -> Result<Self, Located> {
        let (bytes, is_all) = read_head(input, options.limits)
            .map_err(|error| (Place::default(), Problem::Io(error)))?;
        let HeadText {
            encoding,
            carriage_returns,
            text,
        } = check_encoding(&bytes)?;
        let delimiter = match options.mapping.delimiter {
            Some(delimiter) => delimiter,
            None => find_delimiter(&text, options.mapping.skip_lines)?,
        };
        let sample = Sample {
            bytes: &text,
            is_all,
            delimiter,
            options,
        };
        let head = sample.header()?;
        let plan = resolve(&head, &options.mapping)?;
        let units_row = head.units.is_some();
        let header_records = usize::from(head.is_header) + usize::from(units_row);
        let decimal = match options.mapping.decimal {
            Some(decimal) => decimal,
            None => sample.decimal(&plan, header_records)?,
        };
        let dialect = Dialect {
            delimiter,
            decimal,
            header: head.is_header,
            units_row,
            encoding,
            carriage_returns,
            byte_order_mark: bytes.starts_with(BYTE_ORDER_MARK),
        };
        drop(text);
        Ok(Self {
            head: bytes,
            dialect,
            plan,
            header_records,
        })
    }
}

/// Reads enough of the file to decide on its dialect: one head, and more only if the head contains fewer than two
/// lines.
pub(super) fn read_head(input: &mut impl Read, limits: Limits) -> io::Result<(Vec<u8>, bool)> {
    let mut head = Vec::new();
    let mut wanted = HEAD_BYTES;
    loop {
        let missing = (wanted - head.len()) as u64;
        input.by_ref().take(missing).read_to_end(&mut head)?;
        if head.len() < wanted {
            return Ok((head, true));
        }
        let has_rows = memchr::memchr_iter(b'\n', &head).nth(2).is_some();
        if has_rows || wanted > limits.record_bytes {
            return Ok((head, false));
        }
        wanted *= 2;
    }
}

/// First bytes of a file: all of it, or cut at some point.
struct Sample<'a> {
    bytes: &'a [u8],
    is_all: bool,
    delimiter: Delimiter,
    options: &'a Options,
}

impl<'a> Sample<'a> {
    fn records(&self) -> Records<&'a [u8]> {
        Records::new(
            self.bytes,
            Encoding::Utf8,
            self.delimiter,
            self.options.limits,
        )
    }

    fn is_cut(&self, record: Record<'_>) -> bool {
        record.at_end_of_file && !self.is_all
    }

    fn header(&self) -> Result<Head, Located> {
        let Options { mapping, limits } = self.options;
        let mut records = self.records();
        records.skip(mapping.skip_lines, 0)?;
        let first = records.next()?.ok_or((Place::default(), Problem::Empty))?;
        let line = first.line;
        if self.is_cut(first) {
            let bound = limits.record_bytes as u64;
            return Err((
                Place::line(line),
                Problem::Limit {
                    budget: Budget::RecordBytes,
                    bound,
                },
            ));
        }
        let first: Vec<String> = first.iter().map(str::to_owned).collect();
        let number = first.iter().position(|field| number::is_number_like(field));
        let is_header = mapping.header.unwrap_or(number.is_none());
        let is_explained = mapping.header.is_some() || mapping.time.is_some();
        if let Some(field) = number.filter(|_| !is_explained) {
            let found = Excerpt::of(&first[field]);
            return Err((Place::cell(line, field, None), Problem::NoHeader { found }));
        }
        let mut units = None;
        if is_header
            && mapping.units_row != Some(false)
            // A damaged second record is reported when it is read as data.
            && let Ok(Some(second)) = records.next()
            && (mapping.units_row == Some(true) || is_units_row(second.iter()))
        {
            units = Some(second.iter().map(str::to_owned).collect());
        }
        Ok(Head {
            line,
            first,
            is_header,
            units,
        })
    }

    /// Returns the decimal separator on which all numbers in the sample agree.
    fn decimal(&self, plan: &Plan, header_records: usize) -> Result<Decimal, Located> {
        let voters: Vec<usize> = std::iter::once(&plan.time)
            .chain(&plan.signals)
            .filter(|column| column.thousands.is_none())
            .map(|column| column.field)
            .collect();
        let mut records = self.records();
        records.skip(self.options.mapping.skip_lines, header_records)?;
        let mut vote = DecimalVote::default();
        // A damaged record ends the evaluation here, and is reported when it is read as data.
        while let Ok(Some(record)) = records.next() {
            if record.len() == plan.fields && !self.is_cut(record) {
                voters
                    .iter()
                    .for_each(|&field| vote.add(record.line, field, record.get(field)));
            }
        }
        vote.result()
            .map_err(|(ballot, problem)| (plan.place(ballot.line, ballot.field), problem))
    }
}
