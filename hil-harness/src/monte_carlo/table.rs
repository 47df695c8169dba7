//! Table of rows as a Parquet file.

use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::vec;

use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType, ZstdLevel};
use parquet::column::reader::get_typed_column_reader;
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{ChunkReader, FileReader as _, RowGroupReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use super::columns::{COLUMNS, Field};
use super::row::RigRow;
use super::settings::RunSettings;

/// Name and version of the table, in the metadata of the file.
const SCHEMA: &str = "retarder.rig-table/1";
/// Key of that name.
const SCHEMA_KEY: &str = "schema";
/// Number of rows of a row group. Row groups end at multiples of it, so they depend on the rows only.
const GROUP_ROWS: usize = 4096;

/// Reason why a file is no table of rigs.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file cannot be read.
    #[error("cannot be read: {0}; check the name and the rights")]
    Read(#[from] io::Error),
    /// The file is a Parquet file of another kind, or of another version.
    #[error("not a table of rigs ({SCHEMA}); name files that `retarder control --rigs-out` wrote")]
    NotRigs,
    /// The file is damaged, or not Parquet.
    #[error("damaged or no Parquet file ({reason}); run its shard again")]
    Damaged {
        /// Reason.
        reason: String,
    },
}

impl From<ParquetError> for TableError {
    fn from(error: ParquetError) -> Self {
        Self::Damaged {
            reason: error.to_string(),
        }
    }
}

fn schema() -> TypePtr {
    let columns = COLUMNS.iter().map(|column| {
        let (physical, logical, repetition) = match column.field {
            Field::Count(_) => (
                PhysicalType::INT32,
                Some(LogicalType::integer(32, false)),
                Repetition::REQUIRED,
            ),
            Field::Seed(_) => (
                PhysicalType::INT64,
                Some(LogicalType::integer(64, false)),
                Repetition::REQUIRED,
            ),
            Field::Flag(_) => (PhysicalType::BOOLEAN, None, Repetition::REQUIRED),
            Field::Names(_) => (
                PhysicalType::BYTE_ARRAY,
                Some(LogicalType::String),
                Repetition::REQUIRED,
            ),
            Field::Condition(_) | Field::Figure(_) => {
                (PhysicalType::DOUBLE, None, Repetition::OPTIONAL)
            }
        };
        let built = Type::primitive_type_builder(column.name, physical)
            .with_logical_type(logical)
            .with_repetition(repetition)
            .build();
        Arc::new(built.expect("types and logical types match"))
    });
    let group = Type::group_type_builder("rigs").with_fields(columns.collect());
    Arc::new(group.build().expect("the columns have names"))
}

/// Writes rows to a Parquet file.
#[expect(
    missing_debug_implementations,
    reason = "the writer of the library has none"
)]
pub struct RowWriter<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    rows: Vec<RigRow>,
}

impl<W: Write + Send> RowWriter<W> {
    /// Begins the file; its metadata has `settings`.
    ///
    /// # Errors
    /// Returns the sink's error.
    pub fn new(sink: W, settings: &RunSettings) -> io::Result<Self> {
        let name = KeyValue::new(SCHEMA_KEY.to_owned(), SCHEMA.to_owned());
        let settings = settings.iter();
        let settings = settings.map(|(name, text)| KeyValue::new(name.to_owned(), text.to_owned()));
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_key_value_metadata(Some(std::iter::once(name).chain(settings).collect()))
            .build();
        let writer = SerializedFileWriter::new(sink, schema(), Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(io::Error::other)?,
            rows: Vec::new(),
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Returns the sink's error.
    pub fn push(&mut self, row: RigRow) -> io::Result<()> {
        let is_last = (row.rig as usize + 1).is_multiple_of(GROUP_ROWS);
        self.rows.push(row);
        if is_last {
            self.write_group()?;
        }
        Ok(())
    }

    /// Writes the rest of the file.
    ///
    /// # Errors
    /// Returns the sink's error.
    pub fn finish(mut self) -> io::Result<W> {
        if !self.rows.is_empty() {
            self.write_group()?;
        }
        self.writer.into_inner().map_err(io::Error::other)
    }

    fn write_group(&mut self) -> io::Result<()> {
        let written = self.writer.next_row_group().and_then(|mut group| {
            for column in &COLUMNS {
                write_column(&mut group, column.field, &mut self.rows)?;
            }
            group.close()
        });
        written.map_err(io::Error::other)?;
        self.rows.clear();
        Ok(())
    }
}

fn write_column<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    field: Field,
    rows: &mut [RigRow],
) -> Result<(), ParquetError> {
    match field {
        Field::Count(of) => {
            let values: Vec<i32> = rows.iter_mut().map(|row| of(row).cast_signed()).collect();
            write::<Int32Type, W>(group, &values, None)
        }
        Field::Seed(of) => {
            let values: Vec<i64> = rows.iter_mut().map(|row| of(row).cast_signed()).collect();
            write::<Int64Type, W>(group, &values, None)
        }
        Field::Flag(of) => {
            let values: Vec<bool> = rows.iter_mut().map(|row| *of(row)).collect();
            write::<BoolType, W>(group, &values, None)
        }
        Field::Names(of) => {
            let values: Vec<ByteArray> =
                rows.iter_mut().map(|row| of(row).as_str().into()).collect();
            write::<ByteArrayType, W>(group, &values, None)
        }
        Field::Condition(of) | Field::Figure(of) => {
            let levels: Vec<i16> = rows
                .iter_mut()
                .map(|row| i16::from(of(row).is_some()))
                .collect();
            let values: Vec<f64> = rows.iter_mut().filter_map(|row| *of(row)).collect();
            write::<DoubleType, W>(group, &values, Some(&levels))
        }
    }
}

fn write<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let column = group.next_column()?;
    let mut column = column.ok_or_else(|| ParquetError::General("no such column".to_owned()))?;
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}

/// Reads the rows of a Parquet file, one row group at a time.
#[expect(
    missing_debug_implementations,
    reason = "the reader of the library has none"
)]
pub struct RowReader<R: ChunkReader + 'static> {
    reader: SerializedFileReader<R>,
    settings: RunSettings,
    /// Number of the next row group.
    next_group: usize,
    rows: vec::IntoIter<RigRow>,
}

impl<R: ChunkReader + 'static> RowReader<R> {
    /// Opens a table.
    ///
    /// # Errors
    /// Returns an error if the source is no table of rigs.
    pub fn open(source: R) -> Result<Self, TableError> {
        let reader = guarded(|| Ok(SerializedFileReader::new(source)?))?;
        let file = reader.metadata().file_metadata();
        let metadata = file.key_value_metadata().into_iter().flatten();
        let mut metadata = metadata.map(|pair| (pair.key.clone(), pair.value.clone()));
        let is_ours = metadata.next() == Some((SCHEMA_KEY.to_owned(), Some(SCHEMA.to_owned())))
            && file.schema_descr().root_schema() == &*schema();
        if !is_ours {
            return Err(TableError::NotRigs);
        }
        let settings = metadata.map(|(name, text)| (name, text.unwrap_or_default()));
        let settings = RunSettings::new(settings);
        Ok(Self {
            reader,
            settings,
            next_group: 0,
            rows: Vec::new().into_iter(),
        })
    }

    /// Returns the settings of the run.
    pub fn settings(&self) -> &RunSettings {
        &self.settings
    }

    /// Returns the number of all rows.
    pub fn row_count(&self) -> u64 {
        self.reader.metadata().file_metadata().num_rows().max(0) as u64
    }

    fn read_group(&mut self) -> Result<(), TableError> {
        let rows = guarded(|| {
            let group = self.reader.get_row_group(self.next_group)?;
            let count = usize::try_from(group.metadata().num_rows()).unwrap_or(usize::MAX);
            if count > GROUP_ROWS {
                return Err(damaged("a row group is too large"));
            }
            let mut rows = vec![RigRow::default(); count];
            for (index, column) in COLUMNS.iter().enumerate() {
                read_column(&*group, index, column.field, &mut rows)?;
            }
            Ok(rows)
        })?;
        self.next_group += 1;
        self.rows = rows.into_iter();
        Ok(())
    }
}

impl<R: ChunkReader + 'static> Iterator for RowReader<R> {
    type Item = Result<RigRow, TableError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.rows.len() == 0 && self.next_group < self.reader.num_row_groups() {
            if let Err(error) = self.read_group() {
                // No row after a damaged group.
                self.next_group = usize::MAX;
                return Some(Err(error));
            }
        }
        self.rows.next().map(Ok)
    }
}

/// Runs `read`. A damaged file may lead the library beyond its own checks.
fn guarded<T>(read: impl FnOnce() -> Result<T, TableError>) -> Result<T, TableError> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err(damaged("the place is unknown")))
}

pub(super) fn damaged(reason: &str) -> TableError {
    TableError::Damaged {
        reason: reason.to_owned(),
    }
}

fn read_column(
    group: &dyn RowGroupReader,
    index: usize,
    field: Field,
    rows: &mut [RigRow],
) -> Result<(), TableError> {
    match field {
        Field::Count(of) => read::<Int32Type>(group, index, rows, |row, value| {
            *of(row) = value.unwrap_or_default().cast_unsigned();
        }),
        Field::Seed(of) => read::<Int64Type>(group, index, rows, |row, value| {
            *of(row) = value.unwrap_or_default().cast_unsigned();
        }),
        Field::Flag(of) => read::<BoolType>(group, index, rows, |row, value| {
            *of(row) = value.unwrap_or_default();
        }),
        Field::Names(of) => read::<ByteArrayType>(group, index, rows, |row, value| {
            let text = value.unwrap_or_default();
            *of(row) = String::from_utf8_lossy(text.data()).into_owned();
        }),
        Field::Condition(of) | Field::Figure(of) => {
            read::<DoubleType>(group, index, rows, |row, value| *of(row) = value)
        }
    }
}

/// Passes each value of a column to `store`, with its row.
fn read<T: DataType>(
    group: &dyn RowGroupReader,
    index: usize,
    rows: &mut [RigRow],
    store: impl Fn(&mut RigRow, Option<T::T>),
) -> Result<(), TableError> {
    let mut reader = get_typed_column_reader::<T>(group.get_column_reader(index)?);
    let is_optional = group
        .metadata()
        .column(index)
        .column_descr()
        .max_def_level()
        > 0;
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let mut count = 0;
    while count < rows.len() {
        let wanted = rows.len() - count;
        let levels = is_optional.then_some(&mut levels);
        let (read, ..) = reader.read_records(wanted, levels, None, &mut values)?;
        if read == 0 {
            return Err(damaged("a column has fewer rows than its group"));
        }
        count += read;
    }
    let mut values = values.into_iter();
    for (row, stored) in rows.iter_mut().enumerate() {
        let is_present = !is_optional || levels.get(row) == Some(&1);
        let value = if is_present { values.next() } else { None };
        store(stored, value);
    }
    Ok(())
}
