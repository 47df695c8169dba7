//! Parquet, MATLAB and HDF5 files of the signals of one time base.

use std::io::{self, Write};
use std::sync::Arc;

use hdf5_pure::mat::{MatBuilder, MatError, Options};
use parquet::basic::{Compression, Repetition, Type as PhysicalType, ZstdLevel};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::csv::header::format_heading;
use crate::csv::writer::check_columns;
use crate::csv::{Column, WriteError};
use crate::{Recording, TimeBaseId};

/// Longest name of a variable of MATLAB (characters).
const VARIABLE_CHARACTERS_MAX: usize = 63;
/// Largest size of a variable of a version 5 file (bytes).
const VARIABLE_BYTES_MAX: usize = (1 << 31) - 1;

/// Named columns of one time base, the time first.
fn columns(recording: &Recording, base: TimeBaseId) -> Result<Vec<(String, &[f64])>, WriteError> {
    let Some(times) = recording.time_base(base) else {
        return Err(WriteError::NoColumns);
    };
    let signals: Vec<_> = recording
        .signals()
        .iter()
        .filter(|signal| signal.time_base() == base)
        .collect();
    let described: Vec<Column> = signals
        .iter()
        .map(|signal| Column {
            name: signal.name().to_owned(),
            unit: signal.unit(),
        })
        .collect();
    check_columns(&described)?;
    let mut columns = vec![("time_s".to_owned(), times.times_s())];
    for signal in signals {
        let heading = format_heading(signal.name(), signal.unit());
        columns.push((heading, signal.values_or_nan()));
    }
    Ok(columns)
}

/// Writes the signals of one time base as Parquet: packed with zstd, a missing sample is null.
///
/// # Errors
/// Returns a [`WriteError`] for a name that no reader accepts, no signal, or the sink's error.
pub fn write_parquet<W: Write + Send>(
    sink: W,
    recording: &Recording,
    base: TimeBaseId,
) -> Result<W, WriteError> {
    let columns = columns(recording, base)?;
    let failed = |error: ParquetError| WriteError::Io(io::Error::other(error));
    let fields = columns.iter().enumerate().map(|(index, (name, _))| {
        let repetition = match index {
            0 => Repetition::REQUIRED,
            _ => Repetition::OPTIONAL,
        };
        let field = Type::primitive_type_builder(name, PhysicalType::DOUBLE);
        field.with_repetition(repetition).build().map(Arc::new)
    });
    let fields = fields.collect::<Result<_, _>>().map_err(failed)?;
    let schema = Type::group_type_builder("recording").with_fields(fields);
    let schema = Arc::new(schema.build().map_err(failed)?);
    let provenance = recording.provenance();
    let source = KeyValue::new("source".to_owned(), provenance.source.clone());
    let notes = provenance.notes.iter();
    let notes = notes.map(|note| KeyValue::new(note.key.clone(), note.value.clone()));
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_key_value_metadata(Some(std::iter::once(source).chain(notes).collect()));
    let properties = Arc::new(properties.build());
    let mut writer = SerializedFileWriter::new(sink, schema, properties).map_err(failed)?;
    let mut group = writer.next_row_group().map_err(failed)?;
    for (index, (_, values)) in columns.iter().enumerate() {
        let Some(mut column) = group.next_column().map_err(failed)? else {
            break;
        };
        let typed = column.typed::<DoubleType>();
        let written = match index {
            0 => typed.write_batch(values, None, None),
            _ => {
                let levels: Vec<i16> = values.iter().map(|one| i16::from(!one.is_nan())).collect();
                let present: Vec<f64> =
                    values.iter().copied().filter(|one| !one.is_nan()).collect();
                typed.write_batch(&present, Some(&levels), None)
            }
        };
        written.map_err(failed)?;
        column.close().map_err(failed)?;
    }
    group.close().map_err(failed)?;
    writer.into_inner().map_err(failed)
}

/// Writes the signals of one time base as a MATLAB file of version 5, which every MATLAB, Octave and SciPy reads: one
/// column vector for each, NaN where missing. Characters that a variable cannot have become `_`.
///
/// # Errors
/// Returns a [`WriteError`] for a name that no reader accepts, no signal, a signal of 2 GiB, or the sink's error.
pub fn write_matlab<W: Write>(
    mut sink: W,
    recording: &Recording,
    base: TimeBaseId,
) -> Result<W, WriteError> {
    let columns = columns(recording, base)?;
    let mut header = [b' '; 116];
    let text = b"MATLAB 5.0 MAT-file, written by retarder";
    header[..text.len()].copy_from_slice(text);
    sink.write_all(&header)?;
    // No subsystem data; version 1.0, low byte first.
    sink.write_all(&[0; 8])?;
    sink.write_all(&[0x00, 0x01, b'I', b'M'])?;
    let mut taken: Vec<String> = Vec::new();
    for (name, values) in columns {
        let name = variable(&name, &taken);
        write_vector(&mut sink, &name, values)?;
        taken.push(name);
    }
    sink.flush()?;
    Ok(sink)
}

/// Writes the signals of one time base as HDF5 in the form of MATLAB v7.3, which MATLAB and h5py read: a dataset of one column for each
/// signal, of any size, NaN where missing. Names are those of [`write_matlab`].
///
/// # Errors
/// Returns a [`WriteError`] for a name that no reader accepts, no signal, or the sink's error.
pub fn write_matlab_hdf5<W: Write>(
    mut sink: W,
    recording: &Recording,
    base: TimeBaseId,
) -> Result<W, WriteError> {
    let columns = columns(recording, base)?;
    let failed = |error: MatError| WriteError::Io(io::Error::other(error));
    let mut builder = MatBuilder::new(Options::default());
    let mut taken: Vec<String> = Vec::new();
    for (name, values) in columns {
        let name = variable(&name, &taken);
        let dimensions = [values.len(), 1];
        builder
            .write_f64(&name, &dimensions, values)
            .map_err(failed)?;
        taken.push(name);
    }
    builder.finish_to(&mut sink).map_err(failed)?;
    sink.flush()?;
    Ok(sink)
}

/// Returns the name of a variable that is not taken yet.
fn variable(name: &str, taken: &[String]) -> String {
    let is_allowed = |character: char| character.is_ascii_alphanumeric() || character == '_';
    let allowed = name
        .chars()
        .map(|one| if is_allowed(one) { one } else { '_' });
    let mut variable: String = allowed.collect();
    if !variable.starts_with(|first: char| first.is_ascii_alphabetic()) {
        variable.insert(0, 'x');
    }
    variable.truncate(VARIABLE_CHARACTERS_MAX);
    let mut number = 1;
    let mut free = variable.clone();
    while taken.contains(&free) {
        number += 1;
        let suffix = format!("_{number}");
        variable.truncate(VARIABLE_CHARACTERS_MAX - suffix.len());
        free = format!("{variable}{suffix}");
    }
    free
}

fn write_vector(sink: &mut impl Write, name: &str, values: &[f64]) -> Result<(), WriteError> {
    let padded = name.len().next_multiple_of(8);
    let bytes = 16 + 16 + 8 + padded + 8 + 8 * values.len();
    if bytes > VARIABLE_BYTES_MAX {
        let text = format!("{name} has more than 2 GiB; write a file `.h5`");
        return Err(WriteError::Io(io::Error::other(text)));
    }
    let mut words = |words: &[u32]| -> io::Result<()> {
        let mut bytes = words.iter().flat_map(|word| word.to_le_bytes());
        sink.write_all(&bytes.by_ref().collect::<Vec<u8>>())
    };
    // Matrix; flags: class double; dimensions: a column; then the name.
    words(&[14, bytes as u32])?;
    words(&[6, 8, 6, 0])?;
    words(&[5, 8, values.len() as u32, 1])?;
    words(&[1, name.len() as u32])?;
    sink.write_all(name.as_bytes())?;
    sink.write_all(&vec![0; padded - name.len()])?;
    let size = [9, 8 * values.len() as u32];
    sink.write_all(&size.map(u32::to_le_bytes).concat())?;
    for value in values {
        sink.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_has_a_name_that_matlab_accepts_and_no_other_has() {
        assert_eq!(variable("p_ch_bar_gauge", &[]), "p_ch_bar_gauge");
        assert_eq!(variable("2 Drücke [bar]", &[]), "x2_Dr_cke__bar_");
        let long = "a".repeat(80);
        let first = variable(&long, &[]);
        assert_eq!(first.len(), VARIABLE_CHARACTERS_MAX);
        let second = variable(&long, &[first]);
        assert!(
            second.ends_with("a_2") && second.len() == VARIABLE_CHARACTERS_MAX,
            "{second}"
        );
    }
}
