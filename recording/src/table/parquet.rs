//! Parquet files: columns of numbers, times and dates.

use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::basic::{LogicalType, TimeUnit, Type as PhysicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::Limits;
use super::columns::{Budget, Columns, NumberColumn};
use super::error::{Located, damaged};
use super::pages;
use crate::{Clock, StartTime, Unit};

/// Number of rows that are decoded at once.
const ROWS_PER_BATCH: usize = 1 << 14;

/// Returns the columns of a file.
pub(super) fn columns(bytes: Vec<u8>, limits: Limits) -> Result<Columns, Located> {
    // The library checks most of what it reads; a damaged file may lead it beyond its own checks.
    catch_unwind(AssertUnwindSafe(|| read(Bytes::from(bytes), limits)))
        .unwrap_or_else(|_| Err(damaged("the place cannot be found")))
}

fn read(bytes: Bytes, limits: Limits) -> Result<Columns, Located> {
    pages::check_schema(&bytes)?;
    let reader = SerializedFileReader::new(bytes.clone()).map_err(damaged)?;
    let file = reader.metadata().file_metadata();
    let described = file.schema_descr().columns();
    let mut budget = Budget::new(limits);
    budget.check_columns(described.len())?;
    let mut columns = Vec::with_capacity(described.len());
    for (index, column) in described.iter().enumerate() {
        let path = column.path().string();
        let kind = match Kind::of(column) {
            Ok(kind) => kind,
            Err(reason) => {
                columns.push(NumberColumn::new(
                    &path,
                    column.name(),
                    Err(reason.to_owned()),
                ));
                continue;
            }
        };
        let mut values = Values::new(kind, column.max_def_level());
        for number in 0..reader.num_row_groups() {
            let group = reader.get_row_group(number).map_err(damaged)?;
            let rows = u64::try_from(group.metadata().num_rows())
                .map_err(|_| damaged("a group has a negative number of rows"))?;
            budget.take_values(rows)?;
            let chunk = chunk(&bytes, group.metadata().column(index));
            let chunk = chunk.ok_or_else(|| damaged("a column lies outside of the file"))?;
            pages::check(chunk, &budget)?;
            let reader = group.get_column_reader(index).map_err(damaged)?;
            let before = values.numbers.len() as u64;
            values.read(reader, rows).map_err(damaged)?;
            if values.numbers.len() as u64 - before != rows {
                return Err(damaged("a column has fewer rows than its group"));
            }
        }
        columns.push(values.column(&path, column.name()));
    }
    Ok(Columns {
        layout: format!("Parquet, {} rows", file.num_rows()),
        producer: file.created_by().map(str::to_owned),
        columns,
    })
}

/// Returns the bytes of a column, or `None` if they are not in the file.
fn chunk<'a>(bytes: &'a Bytes, column: &ColumnChunkMetaData) -> Option<&'a [u8]> {
    let first = column.dictionary_page_offset();
    let begin = usize::try_from(first.unwrap_or(column.data_page_offset())).ok()?;
    let length = usize::try_from(column.compressed_size()).ok()?;
    bytes.get(begin..begin.checked_add(length)?)
}

/// Meaning of the numbers of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Numbers as they are.
    Plain,
    /// Unsigned integers of this width in signed ones.
    Unsigned,
    /// Times since midnight, in this part of a second.
    Time { per_second: f64 },
    /// Dates with times since 1970 in this part of a second, in universal or local time.
    Date { ns: i64, is_utc: bool },
}

impl Kind {
    /// Returns the kind of a column, or the reason why it has no numbers.
    fn of(column: &ColumnDescriptor) -> Result<Self, &'static str> {
        if column.max_rep_level() > 0 || column.path().parts().len() > 1 {
            return Err("a nested column");
        }
        match column.physical_type() {
            PhysicalType::BYTE_ARRAY => return Err("texts"),
            PhysicalType::FIXED_LEN_BYTE_ARRAY => return Err("bytes or decimal numbers"),
            PhysicalType::INT96 => {
                return Err("dates of an old kind (INT96); save them as TIMESTAMP");
            }
            _ => {}
        }
        Ok(match column.logical_type_ref() {
            Some(LogicalType::Integer(integer)) if !integer.is_signed => Self::Unsigned,
            Some(LogicalType::Time(time)) => Self::Time {
                per_second: 1e9 / ns_of(&time.unit) as f64,
            },
            Some(LogicalType::Timestamp(date)) => Self::Date {
                ns: ns_of(&date.unit),
                is_utc: date.is_adjusted_to_u_t_c,
            },
            Some(LogicalType::Date) => return Err("dates without a time of day"),
            Some(LogicalType::Decimal(_)) => return Err("decimal numbers; save them as DOUBLE"),
            _ => Self::Plain,
        })
    }
}

/// Returns the length of a unit (ns).
fn ns_of(unit: &TimeUnit) -> i64 {
    match unit {
        TimeUnit::MILLIS => 1_000_000,
        TimeUnit::MICROS => 1_000,
        TimeUnit::NANOS => 1,
    }
}

/// Numbers of a column while it is read.
struct Values {
    kind: Kind,
    /// Definition level of a present value.
    present: i16,
    numbers: Vec<f64>,
    /// First date, in the unit of the file.
    first: Option<i64>,
}

impl Values {
    fn new(kind: Kind, present: i16) -> Self {
        Self {
            kind,
            present,
            numbers: Vec::new(),
            first: None,
        }
    }

    fn read(&mut self, reader: ColumnReader, rows: u64) -> Result<(), ParquetError> {
        let is_unsigned = self.kind == Kind::Unsigned;
        match reader {
            ColumnReader::BoolColumnReader(reader) => {
                self.add(reader, rows, |_, value| f64::from(u8::from(value)))
            }
            ColumnReader::Int32ColumnReader(reader) => {
                self.add(reader, rows, |values, value| match is_unsigned {
                    true => f64::from(value as u32),
                    false => values.of_integer(i64::from(value)),
                })
            }
            ColumnReader::Int64ColumnReader(reader) => {
                self.add(reader, rows, |values, value| match is_unsigned {
                    true => value as u64 as f64,
                    false => values.of_integer(value),
                })
            }
            ColumnReader::FloatColumnReader(reader) => {
                self.add(reader, rows, |_, value| f64::from(value))
            }
            ColumnReader::DoubleColumnReader(reader) => self.add(reader, rows, |_, value| value),
            _ => Err(ParquetError::General(
                "another type than its schema".to_owned(),
            )),
        }
    }

    /// Returns the number of an integer; of a date, the time since the first one (s).
    fn of_integer(&mut self, value: i64) -> f64 {
        match self.kind {
            Kind::Plain | Kind::Unsigned => value as f64,
            Kind::Time { per_second } => value as f64 / per_second,
            Kind::Date { ns, .. } => {
                let first = *self.first.get_or_insert(value);
                let since = i128::from(value) - i128::from(first);
                (since * i128::from(ns)) as f64 / 1e9
            }
        }
    }

    fn add<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        rows: u64,
        number: impl Fn(&mut Self, T::T) -> f64,
    ) -> Result<(), ParquetError> {
        let mut rest = rows;
        while rest > 0 {
            let wanted = ROWS_PER_BATCH.min(usize::try_from(rest).unwrap_or(ROWS_PER_BATCH));
            let (mut levels, mut values) = (Vec::new(), Vec::new());
            let (read, ..) = reader.read_records(wanted, Some(&mut levels), None, &mut values)?;
            if read == 0 {
                break;
            }
            rest -= read as u64;
            let mut values = values.into_iter();
            for row in 0..read {
                let is_present = self.present == 0 || levels.get(row) == Some(&self.present);
                let value = match (is_present, is_present.then(|| values.next()).flatten()) {
                    (false, _) => f64::NAN,
                    (true, Some(value)) => number(self, value),
                    (true, None) => {
                        return Err(ParquetError::General("a value is missing".to_owned()));
                    }
                };
                self.numbers.push(value);
            }
        }
        Ok(())
    }

    fn column(self, path: &str, name: &str) -> NumberColumn {
        let mut column = NumberColumn::new(path, name, Ok(self.numbers));
        match self.kind {
            Kind::Plain | Kind::Unsigned => {}
            Kind::Time { .. } => Unit::Second.token().clone_into(&mut column.unit),
            Kind::Date { ns, is_utc } => {
                Unit::Second.token().clone_into(&mut column.unit);
                let since_1970_ns = self.first.and_then(|first| first.checked_mul(ns));
                column.start = since_1970_ns.and_then(|ns| {
                    Some(StartTime {
                        since_1970_ns: u64::try_from(ns).ok()?,
                        clock: match is_utc {
                            true => Clock::Utc { ahead_min: 0 },
                            false => Clock::Local,
                        },
                    })
                });
            }
        }
        column
    }
}
