//! Reader of requirements files: it finds every problem before it uses anything.

use core::ops::Range;

use toml_edit::{Document, Item};

use super::error::{Problem, RequirementFileError};
use super::keys::{KEYS, Key, Kind, tables};
use crate::requirement::Requirement;

/// Two values, the first of which is below the second.
struct Ordered {
    lower: &'static str,
    upper: &'static str,
    values: fn(&Requirement) -> [f64; 2],
}

const ORDERED: [Ordered; 4] = [
    Ordered {
        lower: "settling.lowest_psup",
        upper: "settling.highest_psup",
        values: |requirement| requirement.operating_range_psup,
    },
    Ordered {
        lower: "vent.to_psup",
        upper: "vent.from_psup",
        values: |requirement| [requirement.vent_to_psup, requirement.vent_from_psup],
    },
    Ordered {
        lower: "valves.duty_min_fill_pct",
        upper: "valves.duty_max_fill_pct",
        values: |requirement| requirement.duty_fill_pct,
    },
    Ordered {
        lower: "valves.duty_min_vent_pct",
        upper: "valves.duty_max_vent_pct",
        values: |requirement| requirement.duty_vent_pct,
    },
];

pub(super) fn read(text: &str, name: &str) -> Result<Requirement, RequirementFileError> {
    let document = Document::parse(text).map_err(|error| {
        let message = error.message().trim().replace('\n', ", ");
        let line = line_of(text, error.span());
        RequirementFileError::new(name, vec![Problem::Syntax { line, message }])
    })?;
    let mut reader = Reader {
        text,
        requirement: Requirement::THESIS,
        lines: Vec::new(),
        problems: Vec::new(),
    };
    for (table, item) in document.iter() {
        reader.table(table, item);
    }
    reader.check_order();
    match reader.problems.is_empty() {
        true => Ok(reader.requirement),
        false => Err(RequirementFileError::new(name, reader.problems)),
    }
}

struct Reader<'a> {
    text: &'a str,
    requirement: Requirement,
    /// Keys of the file with their lines.
    lines: Vec<(String, usize)>,
    problems: Vec<Problem>,
}

impl Reader<'_> {
    fn table(&mut self, table: &str, item: &Item) {
        let line = line_of(self.text, item.span());
        let Some(entries) = item.as_table_like().filter(|_| tables().contains(&table)) else {
            self.problems.push(Problem::UnknownTable {
                line,
                table: table.to_owned(),
            });
            return;
        };
        for (name, item) in entries.iter() {
            let line = line_of(self.text, item.span());
            let known = KEYS
                .iter()
                .find(|key| key.table == table && key.name == name);
            match known {
                Some(key) => self.value(key, item, line),
                None => self.problems.push(Problem::UnknownKey {
                    line,
                    table: table.to_owned(),
                    key: name.to_owned(),
                }),
            }
        }
    }

    fn value(&mut self, key: &'static Key, item: &Item, line: usize) {
        let number = || {
            item.as_float()
                .or(item.as_integer().map(|whole| whole as f64))
        };
        let (value, range) = match key.kind {
            Kind::Number(min, max) => (number(), min..=max),
            Kind::Whole(min, max) => (
                item.as_integer().map(|whole| whole as f64),
                min.into()..=max.into(),
            ),
            Kind::Word(words) => {
                let index = item
                    .as_str()
                    .and_then(|found| words.iter().position(|word| *word == found));
                (index.map(|index| index as f64), 0.0..=f64::INFINITY)
            }
            Kind::Flag => (item.as_bool().map(f64::from), 0.0..=1.0),
        };
        let problem = match value {
            Some(value) if range.contains(&value) => {
                (key.set)(&mut self.requirement, value);
                self.lines.push((key.path(), line));
                return;
            }
            Some(found) => Problem::OutOfRange { line, key, found },
            None => Problem::WrongValue {
                line,
                key,
                found: item
                    .span()
                    .and_then(|span| self.text.get(span))
                    .unwrap_or_default()
                    .chars()
                    .take(60)
                    .collect(),
            },
        };
        self.problems.push(problem);
    }

    fn check_order(&mut self) {
        for Ordered {
            lower,
            upper,
            values,
        } in ORDERED
        {
            let found = values(&self.requirement);
            let stated = self
                .lines
                .iter()
                .find(|(path, _)| path == lower || path == upper);
            if let Some((_, line)) = stated
                && found[0] >= found[1]
            {
                self.problems.push(Problem::NotBelow {
                    line: *line,
                    lower,
                    upper,
                    found,
                });
            }
        }
    }
}

fn line_of(text: &str, span: Option<Range<usize>>) -> usize {
    let end = span.map_or(0, |span| span.start.min(text.len()));
    let before = text.as_bytes()[..end].iter();
    1 + before.filter(|byte| **byte == b'\n').count()
}
