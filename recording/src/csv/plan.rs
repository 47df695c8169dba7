//! Assignment of the fields of a record to the time and to signals.

use std::ops::RangeInclusive;

use super::complement::Constant;
use super::error::{Excerpt, Located, Place};
use super::header::{parse_heading, parse_heading_over_unit};
use super::mapping::{ColumnKey, Conversion, MappedColumn, Mapping};
use super::problem::Problem;
use crate::name::{NameError, is_time_column};
use crate::{Converter, Unit};

/// Columns of a file, resolved once.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) fields: usize,
    pub(super) time: FieldPlan,
    pub(super) to_seconds: Converter,
    pub(super) signals: Vec<FieldPlan>,
    /// Signals without a column, which are constant according to the mapping.
    pub(super) constants: Vec<(String, Constant)>,
    /// Whether a separator at the end of each line makes a last column without name and content.
    pub(super) empty_last: bool,
    headers: Option<Vec<String>>,
}

/// Column that is read.
#[derive(Clone, Debug)]
pub(super) struct FieldPlan {
    pub(super) field: usize,
    pub(super) name: String,
    pub(super) unit: Unit,
    pub(super) conversion: Conversion,
    pub(super) thousands: Option<char>,
    pub(super) check_scale: bool,
    /// Range of the values; others count as missing.
    pub(super) plausible: Option<RangeInclusive<f64>>,
    pub(super) is_clock: bool,
}

impl FieldPlan {
    fn plain(field: usize, name: String, unit: Unit) -> Self {
        Self {
            field,
            name,
            unit,
            conversion: Conversion::NONE,
            thousands: None,
            check_scale: true,
            plausible: None,
            is_clock: false,
        }
    }

    fn mapped(field: usize, name: &str, column: &MappedColumn) -> Self {
        Self {
            conversion: column.conversion,
            thousands: column.thousands,
            check_scale: column.check_scale,
            plausible: column.plausible.clone(),
            is_clock: column.is_clock,
            ..Self::plain(field, name.to_owned(), column.unit)
        }
    }
}

impl Plan {
    /// Returns the place of a field in a line, with its header.
    pub(super) fn place(&self, line: u64, field: usize) -> Place {
        let header = self.headers.as_ref().and_then(|headers| headers.get(field));
        Place::cell(line, field, header.map(String::as_str))
    }

    /// Returns the name of a field in a mapping file.
    pub(super) fn column_key(&self, field: usize) -> String {
        match self.headers.as_ref().and_then(|headers| headers.get(field)) {
            Some(header) if !header.contains(['"', '\\']) && !header.contains(char::is_control) => {
                format!("\"{header}\"")
            }
            _ => (field + 1).to_string(),
        }
    }
}

/// Head of a file: its first record as header or as data, and the units below it.
pub(super) struct Head {
    pub(super) line: u64,
    pub(super) first: Vec<String>,
    pub(super) is_header: bool,
    pub(super) units: Option<Vec<String>>,
}

impl Head {
    fn place(&self, field: usize) -> Place {
        Place::cell(self.line, field, None)
    }

    fn shown(&self) -> Excerpt {
        if self.is_header {
            Excerpt::of(&self.first.join(", "))
        } else {
            Excerpt::of(&format!("{} columns without header", self.first.len()))
        }
    }

    fn find(&self, key: &ColumnKey) -> Result<usize, Located> {
        let missing = |wanted: String| {
            let problem = Problem::MappedColumnMissing {
                wanted,
                found: self.shown(),
            };
            (Place::line(self.line), problem)
        };
        match key {
            ColumnKey::Number(number) => match (*number as usize).checked_sub(1) {
                Some(field) if field < self.first.len() => Ok(field),
                _ => Err(missing(number.to_string())),
            },
            ColumnKey::Header(wanted) => {
                let mut fields = (0..self.first.len())
                    .filter(|&field| self.is_header && self.first[field] == *wanted);
                let field = fields.next().ok_or_else(|| missing(wanted.clone()))?;
                match fields.next() {
                    None => Ok(field),
                    Some(second) => Err((
                        self.place(second),
                        Problem::MappedColumnTwice {
                            wanted: wanted.clone(),
                        },
                    )),
                }
            }
        }
    }
}

/// Resolves every column by the mapping, or otherwise by its header.
pub(super) fn resolve(head: &Head, mapping: &Mapping) -> Result<Plan, Located> {
    let fields = head.first.len();
    let mut explained = vec![false; fields];
    for key in &mapping.ignore {
        explained[head.find(key)?] = true;
    }
    let mut time = None;
    if let Some(column) = &mapping.time {
        let field = head.find(&column.column)?;
        explained[field] = true;
        time = Some(FieldPlan::mapped(field, "time", column));
    }
    let mut signals = Vec::new();
    for (name, column) in &mapping.signals {
        let field = head.find(&column.column)?;
        explained[field] = true;
        signals.push(FieldPlan::mapped(field, name, column));
    }
    let mut empty_last = false;
    for field in (0..fields).filter(|&field| !explained[field]) {
        let text = head.first[field].as_str();
        let at_field = |problem| (head.place(field), problem);
        if !head.is_header {
            return Err(at_field(Problem::Unmapped {
                found: Excerpt::of(text),
            }));
        }
        let unit = head
            .units
            .as_ref()
            .and_then(|units| units.get(field))
            .map_or("", String::as_str);
        if text.is_empty() {
            if field + 1 == fields && unit.is_empty() {
                empty_last = true;
                continue;
            }
            return Err(at_field(Problem::Name {
                found: Excerpt::of(text),
                problem: NameError::Empty,
            }));
        }
        let heading = match head.units.as_ref() {
            Some(_) => parse_heading_over_unit(text, unit, mapping.reference),
            None => parse_heading(text, mapping.reference),
        };
        let heading = heading.map_err(at_field)?;
        let column = FieldPlan::plain(field, heading.name, heading.unit);
        if !is_time_column(&column.name, column.unit) {
            signals.push(column);
        } else if let Some(first) = &time {
            return Err(at_field(Problem::TwoTimeColumns {
                first_column: first.field + 1,
            }));
        } else {
            time = Some(column);
        }
    }
    signals.sort_by(|a, b| (a.field, &a.name).cmp(&(b.field, &b.name)));
    refuse_duplicates(head, mapping, &signals)?;
    let no_time = || {
        (
            Place::line(head.line),
            Problem::NoTimeColumn {
                found: head.shown(),
            },
        )
    };
    let time = time.ok_or_else(no_time)?;
    let to_seconds = time.unit.converter(Unit::Second).map_err(|_| no_time())?;
    if signals.is_empty() {
        return Err((Place::line(head.line), Problem::NoSignal));
    }
    let headers = head.is_header.then(|| head.first.clone());
    Ok(Plan {
        fields,
        time,
        to_seconds,
        constants: constants(mapping, &signals),
        signals,
        empty_last,
        headers,
    })
}

/// Returns the constants of the mapping for a file with these columns.
fn constants(mapping: &Mapping, signals: &[FieldPlan]) -> Vec<(String, Constant)> {
    let is_logged = |name: &String| signals.iter().any(|signal| signal.name == *name);
    let constants = mapping.constants.iter();
    constants
        .filter(|(name, _)| !is_logged(name))
        .map(|(name, constant)| (name.clone(), constant.clone()))
        .collect()
}

fn refuse_duplicates(head: &Head, mapping: &Mapping, signals: &[FieldPlan]) -> Result<(), Located> {
    let mut seen = std::collections::BTreeMap::new();
    for signal in signals {
        if let Some(first) = seen.insert(&signal.name, signal.field) {
            let problem = Problem::DuplicateName {
                name: signal.name.clone(),
                first_column: first + 1,
            };
            return Err((head.place(signal.field), problem));
        }
        let constant = mapping.constants.get(&signal.name);
        if constant.is_some_and(|constant| !constant.where_absent) {
            let problem = Problem::ConstantLogged {
                name: signal.name.clone(),
            };
            return Err((head.place(signal.field), problem));
        }
    }
    Ok(())
}
