//! Columns of a file: what it states about each, by its format.

use std::sync::Arc;

use super::Draft;
use super::columns::{Column, Use, toml_string};
use crate::csv::header::parse_heading_over_unit;
use crate::csv::mapping::{ColumnKey, MappedColumn};
use crate::csv::{self, Excerpt, Mapping};
use crate::guess::TIME;
use crate::table::Columns;
use crate::values::ColumnValues;
use crate::{LogFormat, LogOptions, mf4};

impl Draft {
    pub(super) fn of_csv(survey: csv::survey::Survey, options: &LogOptions) -> Self {
        let mapping = &options.mapping;
        let reference = mapping.reference;
        let has_header = survey.header_line.is_some();
        let rows = survey.columns.iter().map(|column| column.kept.len()).max();
        let times = Arc::new(
            (0..rows.unwrap_or(0))
                .map(|row| row as f64)
                .collect::<Vec<_>>(),
        );
        let width = survey.headers.len();
        let mut missing_words: Vec<String> = Vec::new();
        let mut bad_rows = survey.ragged;
        let mut remarks = Vec::new();
        let mut columns = Vec::with_capacity(width);
        for (field, found) in survey.columns.into_iter().enumerate() {
            let number = field as u32 + 1;
            let header = &survey.headers[field];
            let unit = survey
                .units
                .as_ref()
                .map_or("", |units| units[field].as_str());
            let is_unique = survey
                .headers
                .iter()
                .filter(|other| *other == header)
                .count()
                == 1;
            let is_named = has_header && is_unique && !header.is_empty();
            let key = match is_named && toml_string(header).is_some() {
                true => header.clone(),
                false => number.to_string(),
            };
            let mut column = Column::new(number, key, header, unit, found.values);
            if column.key != *header {
                column.toml_key = number.to_string();
            }
            if has_header {
                let own = |reference| parse_heading_over_unit(header, unit, reference).ok();
                column.own = own(reference).map(|heading| (heading.name, heading.unit));
                column.needs_reference = column.own.is_some() && own(None).is_none();
            } else {
                column.header = String::new();
            }
            (column.thousands, column.times) = (found.thousands, Arc::clone(&times));
            column.is_clock = found.is_clock;
            column.samples = Arc::new(found.kept);
            let is_key = |key: &ColumnKey| key.is(number, header);
            let given = Given::by(mapping, is_key);
            if let Some(time) = mapping.time.as_ref().filter(|time| is_key(&time.column)) {
                column.give(TIME, time);
            } else if given.is_any() {
                given.to(&mut column);
            } else if field + 1 == width
                && width > 1
                && header.is_empty()
                && column.values.count == 0
                && found.texts == 0
            {
                column.role = Use::Blank;
                "a separator at the end of each line".clone_into(&mut column.reason);
            } else if found.texts > column.values.count {
                column.obstacle = Some(match &found.first_text {
                    Some((_, text)) => format!("texts such as {text}"),
                    None => "texts".to_owned(),
                });
            }
            if column.obstacle.is_none() && !matches!(column.role, Use::Ignored | Use::Blank) {
                missing_words.extend(found.missing_words);
                bad_rows += found.texts;
                if let Some((line, text)) = &found.first_text {
                    let key = Excerpt::of(&column.key);
                    remarks.push(match found.texts {
                        1 => format!("{key}: the cell {text} in line {line} is no number"),
                        cells => format!(
                            "{key}: {cells} cells are no numbers, the first is {text} in line {line}"
                        ),
                    });
                }
            }
            given.push(column, &mut columns);
        }
        missing_words.sort();
        missing_words.dedup();
        missing_words.retain(|word| toml_string(word).is_some());
        if let Some((line, fields)) = survey.first_ragged {
            remarks.push(match survey.ragged {
                1 => format!("line {line} has {fields} fields, the other rows have {width}"),
                rows => format!(
                    "{rows} rows do not have {width} fields, the first is line {line} with {fields}"
                ),
            });
        }
        let mut layout = format!("CSV, {}", survey.dialect);
        match survey.skip_lines {
            0 => {}
            1 => layout += ", after 1 line of preamble",
            lines => layout += &format!(", after {lines} lines of preamble"),
        }
        let assumed = match survey.is_decimal_assumed {
            true => vec![format!(
                "the decimal separator is `{}`, although some numbers allow the other reading",
                survey.dialect.decimal.symbol()
            )],
            false => Vec::new(),
        };
        Self {
            format: LogFormat::Csv,
            layout,
            rows: survey.rows,
            columns,
            csv_dialect: Some((survey.dialect, survey.skip_lines)),
            dialect: survey.stated,
            missing_words,
            assumed,
            remarks,
            bad_rows,
            constants: mapping.constants.keys().cloned().collect(),
        }
    }

    pub(super) fn of_mf4(survey: mf4::survey::Survey, options: &LogOptions) -> Self {
        let mapping = &options.mapping;
        let mut remarks = Vec::new();
        if let Some(reason) = survey.obstacle {
            remarks.push(format!("no numbers were read: {reason}"));
        }
        let mut rows = 0;
        let mut columns = Vec::with_capacity(survey.channels.len());
        for (number, channel) in (1..).zip(survey.channels) {
            rows = rows.max(channel.samples.len() as u64);
            let mut column = Column::new(
                number,
                channel.key,
                &channel.name,
                &channel.unit,
                channel.values,
            );
            column.own = channel.own;
            let strict = parse_heading_over_unit(&channel.name, &channel.unit, None);
            column.needs_reference = column.own.is_some() && strict.is_err();
            column.obstacle = channel.obstacle;
            if column.toml_key.is_empty() {
                column.obstacle =
                    Some("its name has characters that a mapping cannot have".to_owned());
            }
            column.span_s = channel
                .times_s
                .first()
                .zip(channel.times_s.last())
                .map(|(first, last)| last - first);
            (column.times, column.samples) = (channel.times_s, channel.samples);
            let is_key = |key: &ColumnKey| match key {
                ColumnKey::Header(wanted) => *wanted == column.key || *wanted == column.header,
                ColumnKey::Number(_) => false,
            };
            let given = Given::by(mapping, is_key);
            given.to(&mut column);
            given.push(column, &mut columns);
        }
        let groups = match survey.groups {
            1 => "1 group".to_owned(),
            count => format!("{count} groups"),
        };
        let version = f64::from(survey.version) / 100.0;
        let producer = survey.producer.map_or_else(String::new, |name| {
            format!(", written by {}", Excerpt::of(&name))
        });
        Self {
            format: LogFormat::Mf4,
            layout: format!("MF4, version {version:.2}, {groups} of channels{producer}"),
            rows,
            columns,
            csv_dialect: None,
            dialect: Vec::new(),
            missing_words: Vec::new(),
            assumed: Vec::new(),
            remarks,
            bad_rows: 0,
            constants: mapping.constants.keys().cloned().collect(),
        }
    }

    pub(super) fn of_table(table: Columns, format: LogFormat, options: &LogOptions) -> Self {
        let mapping = &options.mapping;
        let rows = table
            .columns
            .iter()
            .filter_map(|column| column.numbers.as_ref().ok())
            .map(Vec::len)
            .max();
        let rows = rows.unwrap_or(0);
        let times = Arc::new((0..rows).map(|row| row as f64).collect::<Vec<_>>());
        let mut columns = Vec::with_capacity(table.columns.len());
        for (number, found) in (1..).zip(table.columns) {
            let (samples, obstacle) = match found.numbers {
                Ok(samples) => (samples, None),
                Err(reason) => (Vec::new(), Some(reason)),
            };
            let values = ColumnValues::of(&samples);
            let mut column = Column::new(number, found.key, &found.header, &found.unit, values);
            if column.toml_key.is_empty() {
                column.toml_key = number.to_string();
            }
            let own =
                |reference| parse_heading_over_unit(&found.header, &found.unit, reference).ok();
            column.own = own(mapping.reference).map(|heading| (heading.name, heading.unit));
            column.needs_reference = column.own.is_some() && own(None).is_none();
            column.obstacle = obstacle;
            (column.times, column.samples) = (Arc::clone(&times), Arc::new(samples));
            let is_key = |key: &ColumnKey| key.is(number, &column.key);
            let time = mapping.time.as_ref().filter(|time| is_key(&time.column));
            let given = Given::by(mapping, is_key);
            match time {
                Some(time) => column.give(TIME, time),
                None => given.to(&mut column),
            }
            given.push(column, &mut columns);
        }
        let producer = table.producer.map_or_else(String::new, |name| {
            format!(", written by {}", Excerpt::of(&name))
        });
        Self {
            format,
            layout: format!("{}{producer}", table.layout),
            rows: rows as u64,
            columns,
            csv_dialect: None,
            dialect: Vec::new(),
            missing_words: Vec::new(),
            assumed: Vec::new(),
            remarks: Vec::new(),
            bad_rows: 0,
            constants: mapping.constants.keys().cloned().collect(),
        }
    }
}

/// Signals that a mapping takes from one column, and whether it ignores the column.
struct Given<'a> {
    signals: Vec<(&'a String, &'a MappedColumn)>,
    is_ignored: bool,
}

impl<'a> Given<'a> {
    fn by(mapping: &'a Mapping, is_key: impl Fn(&ColumnKey) -> bool) -> Self {
        let signals = mapping.signals.iter();
        Self {
            signals: signals
                .filter(|(_, mapped)| is_key(&mapped.column))
                .collect(),
            is_ignored: mapping.ignore.iter().any(is_key),
        }
    }

    /// Returns whether the mapping says anything of the column.
    fn is_any(&self) -> bool {
        self.is_ignored || !self.signals.is_empty()
    }

    /// Gives the column what the mapping says of it.
    fn to(&self, column: &mut Column) {
        if let Some((name, mapped)) = self.signals.first() {
            column.give(name, mapped);
        } else if self.is_ignored {
            (column.role, column.is_given) = (Use::Ignored, true);
            "the mapping ignores it".clone_into(&mut column.reason);
        }
    }

    /// Adds the column, once for each of its signals.
    fn push(&self, column: Column, columns: &mut Vec<Column>) {
        let others = self.signals.iter().skip(1).map(|(name, mapped)| {
            let mut other = column.clone();
            other.give(name, mapped);
            other
        });
        let others: Vec<Column> = others.collect();
        columns.push(column);
        columns.extend(others);
    }
}
