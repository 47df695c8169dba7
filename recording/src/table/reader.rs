//! Assignment of columns to signals.

use std::io::Read;

use sha2::{Digest as _, Sha256};

use super::columns::{Columns, NumberColumn};
use super::error::{Located, of_file};
use super::{Limits, TableError, TableProblem};
use crate::csv::header::{Heading, parse_heading_over_unit};
use crate::csv::mapping::{ColumnKey, MappedColumn};
use crate::csv::{Excerpt, Mapping};
use crate::name::is_time_column;
use crate::plausibility::Watch;
use crate::{InputFile, LogFormat, Provenance, Recording, TimeBase, Unit};

/// Maximum number of left-out columns named in an error.
const NAMED_MAX: usize = 3;

/// Options for reading a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Assignment of columns to signals, where their names do not define it.
    pub mapping: Mapping,
    /// Budgets of the reader.
    pub limits: Limits,
}

/// Reads all of `input`, a Parquet or MATLAB file of this format, into a recording. `source_name` is used in messages
/// and in the provenance.
///
/// # Errors
/// Returns the first problem of the file. A column that cannot be a signal is no error: it is left out, see
/// [`Recording::left_out`].
pub fn read(
    source_name: &str,
    input: impl Read,
    format: LogFormat,
    options: &Options,
) -> Result<Recording, TableError> {
    let located = |error| TableError::new(source_name, error);
    let bytes = read_bytes(input, options.limits).map_err(located)?;
    let identity = InputFile {
        size_bytes: bytes.len() as u64,
        sha256: Sha256::digest(&bytes).into(),
    };
    let columns = Columns::parse(bytes, format, options.limits).map_err(located)?;
    let mut provenance = Provenance::from_source(source_name);
    provenance.producer.clone_from(&columns.producer);
    provenance.input = Some(identity);
    let assignment = Assignment {
        columns: &columns.columns,
        mapping: &options.mapping,
    };
    assignment
        .record(Recording::new(provenance))
        .map_err(located)
}

/// Reads the columns of a file, whatever they mean.
pub(crate) fn read_columns(
    input: impl Read,
    format: LogFormat,
    limits: Limits,
) -> Result<Columns, Located> {
    Columns::parse(read_bytes(input, limits)?, format, limits)
}

fn read_bytes(input: impl Read, limits: Limits) -> Result<Vec<u8>, Located> {
    let mut bytes = Vec::new();
    // One byte more than the budget is refused, with a message.
    let read = input
        .take(limits.file_bytes.saturating_add(1))
        .read_to_end(&mut bytes);
    read.map_err(|error| of_file(TableProblem::Io(error)))?;
    Ok(bytes)
}

/// Columns of a file and the mapping that assigns them.
struct Assignment<'a> {
    columns: &'a [NumberColumn],
    mapping: &'a Mapping,
}

/// Column that becomes the time or a signal.
struct Chosen<'a> {
    column: &'a NumberColumn,
    name: String,
    unit: Unit,
    mapped: Option<&'a MappedColumn>,
}

impl Chosen<'_> {
    /// Returns the value of a logged number.
    fn value(&self, logged: f64) -> f64 {
        let converted = self.mapped.map(|mapped| mapped.conversion.value(logged));
        converted.unwrap_or(logged)
    }

    /// Creates a problem of the column.
    fn problem(&self, problem: TableProblem) -> Located {
        (Some(Excerpt::of(&self.column.key)), problem)
    }
}

impl<'a> Assignment<'a> {
    /// Returns the recording with the time and every column that is a signal.
    fn record(&self, mut recording: Recording) -> Result<Recording, Located> {
        let time = self.time()?;
        recording.provenance_mut().start = time.column.start;
        let times_s = self.times_s(&time)?;
        let window = self.mapping.rows;
        let kept = times_s.partition_point(|&time_s| time_s < window.from_s)
            ..times_s.partition_point(|&time_s| time_s <= window.until_s);
        let rows = times_s.len();
        let base = TimeBase::new(times_s[kept.clone()].to_vec())
            .map_err(|_| of_file(TableProblem::NoRowKept))?;
        let instants = base.len();
        let base = recording.add_time_base(base);
        for chosen in self.signals(&time, &mut recording)? {
            let numbers = match &chosen.column.numbers {
                Ok(numbers) if numbers.len() == rows => numbers,
                Ok(numbers) => {
                    let count = numbers.len();
                    let reason = format!("it has {count} values, the time has {rows}");
                    recording.leave_out(&chosen.name, reason);
                    continue;
                }
                Err(reason) => {
                    let reason = reason.clone();
                    return Err(chosen.problem(TableProblem::NotNumbers { reason }));
                }
            };
            let mut values: Vec<f64> = numbers[kept.clone()]
                .iter()
                .map(|&number| chosen.value(number))
                .collect();
            if let Some(row) = values.iter().position(|value| value.is_infinite()) {
                let row = kept.start + row + 1;
                recording.leave_out(&chosen.name, format!("row {row} is infinite; correct it"));
                continue;
            }
            keep_plausible(&chosen, kept.start as u64, &mut values, &mut recording)?;
            let added = recording.add_signal(&*chosen.name, chosen.unit, base, values);
            if let Err(error) = added.map(drop) {
                recording.leave_out(&chosen.name, error.to_string());
            }
        }
        if recording.signals().is_empty() {
            let left_out = first_left_out(&recording);
            return Err(of_file(TableProblem::NoSignal { left_out }));
        }
        for (name, constant) in &self.mapping.constants {
            if constant.where_absent && recording.signal(name).is_some() {
                continue;
            }
            let values = vec![constant.value; instants];
            let added = recording.add_signal(&**name, constant.unit, base, values);
            if added.is_err() {
                let name = Excerpt::of(name);
                return Err(of_file(TableProblem::ConstantLogged { name }));
            }
        }
        Ok(recording)
    }

    /// Returns the time column: that of the mapping, or the first one that states it.
    fn time(&self) -> Result<Chosen<'a>, Located> {
        if let Some(mapped) = &self.mapping.time {
            if mapped.is_clock {
                return Err(of_file(TableProblem::Clock));
            }
            return Ok(Chosen {
                column: &self.columns[self.find(&mapped.column)?],
                name: "time".to_owned(),
                unit: mapped.unit,
                mapped: Some(mapped),
            });
        }
        let own = self.columns.iter().find_map(|column| {
            let heading = self.by_itself(column).ok()?;
            is_time_column(&heading.name, heading.unit).then(|| Chosen::of_heading(column, heading))
        });
        let found = || {
            of_file(TableProblem::NoTime {
                found: self.names(),
            })
        };
        own.ok_or_else(found)
    }

    /// Returns all times (s).
    fn times_s(&self, time: &Chosen<'_>) -> Result<Vec<f64>, Located> {
        let numbers = time.column.numbers.as_ref().map_err(|reason| {
            let reason = reason.clone();
            time.problem(TableProblem::NotNumbers { reason })
        })?;
        let wrong = |reason| time.problem(TableProblem::Time { reason });
        let to_s = time.unit.converter(Unit::Second);
        let to_s = to_s.map_err(|error| wrong(error.to_string()))?;
        let times_s: Vec<f64> = numbers
            .iter()
            .map(|&one| to_s.apply(time.value(one)))
            .collect();
        match TimeBase::new(times_s) {
            Ok(base) => Ok(base.times_s().to_vec()),
            Err(error) => Err(wrong(error.to_string())),
        }
    }

    /// Returns the columns that are signals; the others are left out of the recording with their reasons.
    fn signals(
        &self,
        time: &Chosen<'_>,
        recording: &mut Recording,
    ) -> Result<Vec<Chosen<'a>>, Located> {
        let mut is_open: Vec<bool> = self
            .columns
            .iter()
            .map(|column| !std::ptr::eq(column, time.column))
            .collect();
        for key in &self.mapping.ignore {
            is_open[self.find(key)?] = false;
        }
        let mut signals = Vec::new();
        for (name, mapped) in &self.mapping.signals {
            let index = self.find(&mapped.column)?;
            is_open[index] = false;
            signals.push(Chosen {
                column: &self.columns[index],
                name: name.clone(),
                unit: mapped.unit,
                mapped: Some(mapped),
            });
        }
        for (column, _) in self
            .columns
            .iter()
            .zip(is_open)
            .filter(|(_, is_open)| *is_open)
        {
            match self.by_itself(column) {
                Ok(heading) => signals.push(Chosen::of_heading(column, heading)),
                Err(reason) => recording.leave_out(&column.key, reason),
            }
        }
        Ok(signals)
    }

    /// Returns name and unit that a column states, or the reason why it is no signal.
    fn by_itself(&self, column: &NumberColumn) -> Result<Heading, String> {
        column.numbers.as_ref().map_err(Clone::clone)?;
        let heading = parse_heading_over_unit(&column.header, &column.unit, self.mapping.reference);
        heading.map_err(|problem| format!("{problem}; {}", problem.next_step()))
    }

    fn names(&self) -> Excerpt {
        let names: Vec<&str> = self.columns.iter().map(|column| &*column.key).collect();
        Excerpt::of(&names.join(", "))
    }

    fn find(&self, key: &ColumnKey) -> Result<usize, Located> {
        let (found, wanted) = match key {
            ColumnKey::Number(number) => {
                let index = (*number as usize).checked_sub(1);
                let index = index.filter(|&index| index < self.columns.len());
                (index, number.to_string())
            }
            ColumnKey::Header(wanted) => {
                let mut columns = self.columns.iter();
                let index = columns.position(|column| column.key == *wanted);
                (index, wanted.clone())
            }
        };
        found.ok_or_else(|| {
            of_file(TableProblem::MappedColumnMissing {
                wanted: Excerpt::of(&wanted),
                found: self.names(),
            })
        })
    }
}

impl<'a> Chosen<'a> {
    fn of_heading(column: &'a NumberColumn, heading: Heading) -> Self {
        Self {
            column,
            name: heading.name,
            unit: heading.unit,
            mapped: None,
        }
    }
}

/// Replaces values out of bounds by missing ones and lists them. Refuses a column whose values cannot have its unit. The
/// first of the values is in row `first`, from 0.
fn keep_plausible(
    chosen: &Chosen<'_>,
    first: u64,
    values: &mut [f64],
    recording: &mut Recording,
) -> Result<(), Located> {
    let fail = |(row, implausible)| chosen.problem(TableProblem::Implausible { row, implausible });
    let check_scale = chosen.mapped.is_none_or(|mapped| mapped.check_scale);
    let plausible = chosen.mapped.and_then(|mapped| mapped.plausible.as_ref());
    let mut watch = Watch::new(&chosen.name, chosen.unit, check_scale, None).narrowed_to(plausible);
    let present = (first + 1..)
        .zip(values)
        .filter(|(_, value)| !value.is_nan());
    for (row, value) in present {
        *value = watch
            .take(*value, row)
            .map_err(|implausible| fail((row, implausible)))?;
    }
    let key = || format!("{:?}", chosen.column.key);
    watch.judge(&chosen.name, key, true).map_err(fail)?;
    if let Some(cells) = watch.outside() {
        recording.add_out_of_bounds(cells.clone());
    }
    Ok(())
}

/// Returns the first left-out columns, as the end of a sentence.
fn first_left_out(recording: &Recording) -> String {
    let left_out = recording.left_out();
    let named = left_out.iter().take(NAMED_MAX);
    let text: String = named
        .map(|one| format!("; {}: {}", Excerpt::of(&one.name), one.reason))
        .collect();
    match left_out.len() > NAMED_MAX {
        true => format!("{text}; and {} more", left_out.len() - NAMED_MAX),
        false => text,
    }
}
