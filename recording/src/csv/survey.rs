//! Survey of a file of unknown layout: its dialect, its header, and the numbers of each column. It refuses no cell.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Read};

use super::clock::Clock;
use super::dialect::{HeadText, check_encoding, find_delimiter};
use super::encoding::Encoding;
use super::error::{Excerpt, Located, Place};
use super::header::is_units_row;
use super::number::{self, Evidence, Style, evidence, is_number_like};
use super::opening::read_head;
use super::problem::Problem;
use super::record::{BYTE_ORDER_MARK, Record, Records};
use super::{Decimal, Delimiter, Dialect, Limits, Mapping};
use crate::values::ColumnValues;

/// Number of records from which the layout is found.
const LAYOUT_RECORDS: usize = 2000;
/// Number of cells that are kept for the comparison of columns.
const KEPT_CELLS: usize = 4 << 20;
/// Longest cell of a row of units that this crate does not know (characters).
const UNIT_CHARACTERS: usize = 12;
/// Words that mean a missing sample, in lower case.
const MISSING_WORDS: [&str; 11] = [
    "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---", "inf", "-nan",
];

/// Layout and numbers of a CSV file.
#[derive(Debug)]
pub(crate) struct Survey {
    pub(crate) dialect: Dialect,
    /// Number of lines before the header that are no comment.
    pub(crate) skip_lines: u32,
    /// Line of the header; `None` for a file without one.
    pub(crate) header_line: Option<u64>,
    pub(crate) headers: Vec<String>,
    pub(crate) units: Option<Vec<String>>,
    pub(crate) columns: Vec<SurveyedColumn>,
    pub(crate) rows: u64,
    /// Number of rows with another number of fields, and the first of them.
    pub(crate) ragged: u64,
    pub(crate) first_ragged: Option<(u64, usize)>,
    /// Whether the decimal comma could be a separator of thousands.
    pub(crate) is_decimal_assumed: bool,
    /// Keys of `[dialect]` that the reader does not find by itself, with their values in TOML.
    pub(crate) stated: Vec<(&'static str, String)>,
}

/// Numbers of a column, and what else is in its cells.
#[derive(Debug, Default)]
pub(crate) struct SurveyedColumn {
    pub(crate) values: ColumnValues,
    pub(crate) thousands: Option<char>,
    /// Spellings of missing samples.
    pub(crate) missing_words: BTreeSet<String>,
    /// Whether the numbers are seconds, from dates or times of day.
    pub(crate) is_clock: bool,
    clock: Clock,
    /// Number of cells with another text, and the first of them.
    pub(crate) texts: u64,
    pub(crate) first_text: Option<(u64, Excerpt)>,
    /// First numbers, NaN where missing.
    pub(crate) kept: Vec<f64>,
}

/// Surveys a file. A given mapping decides about the dialect as far as it states it.
pub(crate) fn survey(
    mut input: impl Read,
    mapping: &Mapping,
    limits: Limits,
) -> Result<Survey, Located> {
    let (head, _) =
        read_head(&mut input, limits).map_err(|error| (Place::default(), Problem::Io(error)))?;
    let HeadText {
        encoding,
        carriage_returns,
        text,
    } = check_encoding(&head)?;
    let layout = Layout::of(&text, mapping, limits)?;
    let mut survey = layout.survey(&text, mapping);
    (survey.dialect.encoding, survey.dialect.carriage_returns) = (encoding, carriage_returns);
    drop(text);
    let records = Cursor::new(head).chain(input);
    let mut records = Records::new(records, encoding, survey.dialect.delimiter, limits)
        .with_carriage_returns(carriage_returns);
    let header_records = usize::from(survey.dialect.header) + usize::from(survey.dialect.units_row);
    records.skip(survey.skip_lines, header_records)?;
    let width = survey.columns.len();
    let mut scratch = String::new();
    // A damaged record ends the survey, and is reported when the file is read as a log.
    while let Ok(Some(record)) = records.next() {
        survey.rows += 1;
        if record.len() != width {
            survey.ragged += 1;
            survey
                .first_ragged
                .get_or_insert((record.line, record.len()));
            continue;
        }
        let is_kept = (survey.rows as usize).saturating_mul(width) <= KEPT_CELLS;
        for (field, column) in survey.columns.iter_mut().enumerate() {
            let style = Style {
                decimal: survey.dialect.decimal,
                thousands: column.thousands,
            };
            column.add(
                record.get(field),
                record.line,
                (style, &mapping.missing),
                &mut scratch,
                is_kept,
            );
        }
    }
    Ok(survey)
}

impl SurveyedColumn {
    fn add(
        &mut self,
        cell: &str,
        line: u64,
        (style, missing): (Style, &[String]),
        scratch: &mut String,
        is_kept: bool,
    ) {
        let value = if cell.is_empty() || missing.iter().any(|word| word == cell) {
            f64::NAN
        } else if is_missing_word(cell) {
            self.missing_words.insert(cell.to_owned());
            f64::NAN
        } else {
            let parsed = number::parse(cell, style, scratch).ok();
            // A column of clock times begins with one.
            let is_clock = self.is_clock || self.values.count == 0 && parsed.is_none();
            let read = parsed.filter(|_| !self.is_clock);
            let read = read.or_else(|| {
                self.clock
                    .read(cell)
                    .filter(|_| is_clock)
                    .inspect(|_| self.is_clock = true)
            });
            read.unwrap_or_else(|| {
                self.texts += 1;
                self.first_text
                    .get_or_insert_with(|| (line, Excerpt::of(cell)));
                f64::NAN
            })
        };
        self.values.add(value);
        if is_kept {
            self.kept.push(value);
        }
    }
}

fn is_missing_word(cell: &str) -> bool {
    MISSING_WORDS
        .iter()
        .any(|word| cell.eq_ignore_ascii_case(word))
}

/// Layout of the head of a file.
struct Layout {
    delimiter: Delimiter,
    /// Line and fields of each record.
    records: Vec<(u64, Vec<String>)>,
    width: usize,
    /// Index of the first record with data.
    first_row: usize,
}

impl Layout {
    /// Finds the delimiter with the most rows of one width.
    fn of(head: &[u8], mapping: &Mapping, limits: Limits) -> Result<Self, Located> {
        let delimiters = Delimiter::ALL.into_iter();
        let possible = delimiters.filter(|one| mapping.delimiter.is_none_or(|given| given == *one));
        let mut best: Option<(usize, Self)> = None;
        for delimiter in possible {
            let mut records = Records::new(head, Encoding::Utf8, delimiter, limits);
            records.skip(mapping.skip_lines, 0)?;
            let mut found = Vec::new();
            while found.len() < LAYOUT_RECORDS
                && let Ok(Some(record)) = records.next()
            {
                found.push((record.line, fields(record)));
            }
            let mut widths: BTreeMap<usize, usize> = BTreeMap::new();
            for (_, fields) in found.iter().filter(|(_, fields)| is_row(fields)) {
                *widths.entry(fields.len()).or_default() += 1;
            }
            let Some((&width, &rows)) = widths.iter().max_by_key(|&(_, rows)| rows) else {
                continue;
            };
            let is_first =
                |(_, fields): &(u64, Vec<String>)| fields.len() == width && is_row(fields);
            let Some(first_row) = found.iter().position(is_first) else {
                continue;
            };
            if best.as_ref().is_none_or(|(most, _)| rows > *most) {
                let layout = Self {
                    delimiter,
                    records: found,
                    width,
                    first_row,
                };
                best = Some((rows, layout));
            }
        }
        match best {
            Some((_, layout)) => Ok(layout),
            None => {
                find_delimiter(head, mapping.skip_lines)?;
                Err((Place::default(), Problem::NoData))
            }
        }
    }

    fn survey(self, head: &[u8], mapping: &Mapping) -> Survey {
        let above = |count: usize| {
            let index = self.first_row.checked_sub(count)?;
            let (line, fields) = &self.records[index];
            (fields.len() == self.width && !is_row(fields)).then_some((index, *line, fields))
        };
        let allowed = mapping.header != Some(false);
        let (header, units) = match (above(1), above(2)) {
            (Some(units), Some(header)) if allowed && is_like_units(units.2) => {
                (Some(header), Some(units.2))
            }
            (Some(header), _) if allowed => (Some(header), None),
            _ => (None, None),
        };
        let first = header.map_or(self.first_row, |(index, ..)| index);
        let skip_lines = match first {
            0 => mapping.skip_lines,
            _ => u32::try_from(self.records[first].0 - 1).unwrap_or(u32::MAX),
        };
        let headers: Vec<String> = match header {
            Some((_, _, fields)) => fields.clone(),
            None => (1..=self.width)
                .map(|number| format!("column {number}"))
                .collect(),
        };
        let rows = &self.records[self.first_row..];
        let mut columns: Vec<SurveyedColumn> = (0..self.width)
            .map(|field| SurveyedColumn {
                thousands: thousands(rows, self.width, field),
                ..SurveyedColumn::default()
            })
            .collect();
        for (field, column) in columns.iter_mut().enumerate() {
            let mut mapped = mapping.time.iter().chain(mapping.signals.values());
            let number = field as u32 + 1;
            let given = mapped.find(|one| one.column.is(number, &headers[field]));
            if let Some(separator) = given.and_then(|one| one.thousands) {
                column.thousands = Some(separator);
            }
        }
        let (decimal, is_decimal_assumed) = match mapping.decimal {
            Some(decimal) => (decimal, false),
            None => decimal(rows, &columns),
        };
        let mut stated = Vec::new();
        if skip_lines > 0 && mapping.skip_lines == 0 {
            stated.push(("skip_lines", skip_lines.to_string()));
        }
        let found = find_delimiter(head, skip_lines).ok();
        if found != Some(self.delimiter) && mapping.delimiter.is_none() {
            stated.push(("delimiter", format!("{:?}", self.delimiter.name())));
        }
        if is_decimal_assumed {
            stated.push(("decimal", format!("{:?}", decimal.symbol().to_string())));
        }
        let has_number = |fields: &Vec<String>| fields.iter().any(|field| is_number_like(field));
        if mapping.header.is_none() {
            match header {
                None => stated.push(("header", "false".to_owned())),
                Some((_, _, fields)) if has_number(fields) => {
                    stated.push(("header", "true".to_owned()))
                }
                Some(_) => {}
            }
        }
        if mapping.units_row.is_none() {
            match units {
                Some(units) if !is_units_row(units.iter().map(String::as_str)) => {
                    stated.push(("units_row", "true".to_owned()));
                }
                _ => {}
            }
        }
        Survey {
            dialect: Dialect {
                delimiter: self.delimiter,
                decimal,
                header: header.is_some(),
                units_row: units.is_some(),
                encoding: Encoding::Utf8,
                carriage_returns: false,
                byte_order_mark: head.starts_with(BYTE_ORDER_MARK),
            },
            skip_lines,
            header_line: header.map(|(_, line, _)| line),
            headers,
            units: units.cloned(),
            columns,
            rows: 0,
            ragged: 0,
            first_ragged: None,
            is_decimal_assumed,
            stated,
        }
    }
}

fn fields(record: Record<'_>) -> Vec<String> {
    record.iter().map(str::to_owned).collect()
}

/// Returns whether a record looks like data: at least half of its fields are numbers or empty, and one is a number.
fn is_row(fields: &[String]) -> bool {
    let numbers = fields.iter().filter(|field| is_number_like(field)).count();
    let empty = fields
        .iter()
        .filter(|field| field.is_empty() || is_missing_word(field))
        .count();
    fields.len() > 1 && numbers > 0 && 2 * (numbers + empty) >= fields.len()
}

/// Returns whether a record below the header looks like a row of units, also of unknown ones.
fn is_like_units(fields: &[String]) -> bool {
    is_units_row(fields.iter().map(String::as_str))
        || fields
            .iter()
            .all(|field| field.chars().count() <= UNIT_CHARACTERS && !field.contains(' '))
}

/// Returns the separator of the thousands of a column, if its numbers show one.
fn thousands(rows: &[(u64, Vec<String>)], width: usize, field: usize) -> Option<char> {
    let cells = rows.iter().filter(|(_, fields)| fields.len() == width);
    let grouped = cells
        .map(|(_, fields)| fields[field].as_str())
        .find(|cell| evidence(cell) == Evidence::Grouped)?;
    // Of two different signs, the first separates the thousands; of one sign that repeats, this one does.
    grouped.chars().find(|sign| matches!(sign, '.' | ','))
}

/// Returns the decimal separator of most numbers, and whether it is only assumed.
fn decimal(rows: &[(u64, Vec<String>)], columns: &[SurveyedColumn]) -> (Decimal, bool) {
    let (mut points, mut commas, mut open) = (0_u64, 0_u64, 0_u64);
    for (_, fields) in rows
        .iter()
        .filter(|(_, fields)| fields.len() == columns.len())
    {
        for (field, column) in fields.iter().zip(columns) {
            match (column.thousands, evidence(field)) {
                // `1.234,5`: the other sign is the decimal separator.
                (Some('.'), Evidence::Grouped) if field.contains(',') => commas += 1,
                (Some(','), Evidence::Grouped) if field.contains('.') => points += 1,
                (None, Evidence::Point) => points += 1,
                (None, Evidence::Comma) => commas += 1,
                (None, Evidence::CommaOrGroup) => open += 1,
                _ => {}
            }
        }
    }
    match (points, commas, open) {
        (0, 0, 1..) => (Decimal::Comma, true),
        (_, 0, 0) => (Decimal::Point, false),
        (0, 1.., _) => (Decimal::Comma, false),
        _ if points > commas + open => (Decimal::Point, true),
        _ => (Decimal::Comma, true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surveyed(text: &str) -> Survey {
        survey(text.as_bytes(), &Mapping::default(), Limits::default()).unwrap()
    }

    #[test]
    fn a_header_below_a_preamble_is_found_with_its_units() {
        let text = "Datei: Messung 7\nDatum;23.11.2026\n\nZeit;Druck;Bemerkung\ns;bar;-\n0,00;1,5;ok\n0,01;1,625;ok\n";
        let found = surveyed(text);
        assert_eq!(found.headers, ["Zeit", "Druck", "Bemerkung"]);
        assert_eq!(
            (found.skip_lines, found.header_line, found.rows),
            (3, Some(4), 2)
        );
        assert_eq!(found.units.unwrap(), ["s", "bar", "-"]);
        assert_eq!(found.dialect.decimal, Decimal::Comma);
        assert_eq!(found.stated, [("skip_lines", "3".to_owned())]);
        assert_eq!(found.columns[1].values.greatest, 1.625);
        assert_eq!(found.columns[2].texts, 2);
    }

    #[test]
    fn thousands_and_a_missing_header_are_found() {
        let found = surveyed("0.000;3.826\n500.000;3.83\n1.000.000;3.84\n");
        assert_eq!(found.columns[0].thousands, Some('.'));
        assert_eq!(
            (found.columns[1].thousands, found.dialect.decimal),
            (None, Decimal::Point)
        );
        assert_eq!(found.columns[0].values.greatest, 1_000_000.0);
        assert_eq!(found.stated, [("header", "false".to_owned())]);
        let found = surveyed("t;p\n0;1.234,5\n1;2,5\n");
        assert_eq!(
            (found.columns[1].values.least, found.dialect.decimal),
            (2.5, Decimal::Comma)
        );
    }

    #[test]
    fn missing_words_texts_and_ragged_rows_are_counted_and_not_refused() {
        let found = surveyed("t,p\n0,1.5\n1,NaN\n2,---\n3,broken\n4\n5,2.5\n");
        let column = &found.columns[1];
        let words: Vec<&str> = column.missing_words.iter().map(String::as_str).collect();
        assert_eq!(words, ["---", "NaN"]);
        assert_eq!(
            (column.texts, column.values.count, column.values.missing),
            (1, 2, 3)
        );
        assert_eq!(column.first_text.as_ref().unwrap().0, 5);
        assert_eq!(
            (found.rows, found.ragged, found.first_ragged),
            (6, 1, Some((6, 1)))
        );
    }

    #[test]
    fn a_comma_that_may_separate_thousands_is_an_assumption() {
        let found = surveyed("t;p\n1;1,234\n2;1,235\n");
        assert!(found.is_decimal_assumed);
        assert_eq!(found.stated, [("decimal", "\",\"".to_owned())]);
        assert!(!surveyed("t;p\n0,01;1,234\n0,02;1,235\n").is_decimal_assumed);
    }

    #[test]
    fn a_file_without_rows_is_refused_with_a_reason() {
        let refused = |text: &str| {
            let (_, problem) =
                survey(text.as_bytes(), &Mapping::default(), Limits::default()).unwrap_err();
            problem.code()
        };
        assert_eq!(refused(""), "E-CSV-EMPTY");
        assert_eq!(refused("a text\nwithout columns\n"), "E-CSV-DELIMITER");
        assert_eq!(refused("time_s,p_ch_bar_gauge\n"), "E-CSV-NO-DATA");
    }
}
