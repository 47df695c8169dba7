//! Output of a recording row by row: to the standard output, or to a file that appears when it is complete.

use std::io::{self, BufWriter, StdoutLock};
use std::path::Path;

use recording::csv::{self, Column, Decimals, WriteError};
use recording::{AtomicFile, LogFormat, Provenance, Recording, TimeBase, mf4, table};

use crate::targets::Existing;

/// Destination of the rows.
pub(super) enum RowOutput {
    Standard(csv::Writer<BufWriter<StdoutLock<'static>>>),
    Csv(csv::Writer<AtomicFile>),
    Mf4(mf4::Writer<AtomicFile>),
    Whole(Box<Whole>),
}

/// Rows that are kept until the end, for a format that stores whole columns.
pub(super) struct Whole {
    file: AtomicFile,
    format: LogFormat,
    provenance: Provenance,
    columns: Vec<Column>,
    times_s: Vec<f64>,
    samples: Vec<Vec<f64>>,
}

impl RowOutput {
    /// Begins the file `out`, in the format of its name; `None` is the standard output.
    pub(super) fn begin(
        out: Option<(&Path, Existing)>,
        provenance: &Provenance,
        columns: &[Column],
        decimals: &Decimals,
    ) -> Result<Self, WriteError> {
        let Some((path, existing)) = out else {
            let sink = BufWriter::new(io::stdout().lock());
            let writer = csv::Writer::new(sink, provenance, columns, decimals)?;
            return Ok(Self::Standard(writer));
        };
        let file = existing.begin(path)?;
        Ok(match LogFormat::of_name(path) {
            LogFormat::Csv => Self::Csv(csv::Writer::new(file, provenance, columns, decimals)?),
            LogFormat::Mf4 => Self::Mf4(mf4::Writer::new(file, provenance, columns)?),
            format => Self::Whole(Box::new(Whole {
                file,
                format,
                provenance: provenance.clone(),
                columns: columns.to_vec(),
                times_s: Vec::new(),
                samples: vec![Vec::new(); columns.len()],
            })),
        })
    }

    pub(super) fn write_row(&mut self, time_s: f64, values: &[f64]) -> Result<(), WriteError> {
        match self {
            Self::Standard(writer) => writer.write_row(time_s, values),
            Self::Csv(writer) => writer.write_row(time_s, values),
            Self::Mf4(writer) => writer.write_row(time_s, values),
            Self::Whole(whole) => {
                whole.times_s.push(time_s);
                for (samples, &value) in whole.samples.iter_mut().zip(values) {
                    samples.push(value);
                }
                Ok(())
            }
        }
    }

    /// Makes the file visible under its name.
    pub(super) fn finish(self) -> Result<(), WriteError> {
        match self {
            Self::Standard(writer) => drop(writer.finish()?),
            Self::Csv(writer) => writer.finish()?.commit()?,
            Self::Mf4(writer) => writer.finish()?.commit()?,
            Self::Whole(whole) => whole.write()?.commit()?,
        }
        Ok(())
    }
}

impl Whole {
    fn write(self) -> Result<AtomicFile, WriteError> {
        let failed = |error: String| WriteError::Io(io::Error::other(error));
        let base = TimeBase::new(self.times_s).map_err(|error| failed(error.to_string()))?;
        let mut recording = Recording::new(self.provenance);
        let base = recording.add_time_base(base);
        for (column, samples) in self.columns.into_iter().zip(self.samples) {
            let added = recording.add_signal(column.name, column.unit, base, samples);
            added.map_err(|error| failed(error.to_string()))?;
        }
        match self.format {
            LogFormat::Parquet => table::write_parquet(self.file, &recording, base),
            LogFormat::MatlabHdf5 => table::write_matlab_hdf5(self.file, &recording, base),
            _ => table::write_matlab(self.file, &recording, base),
        }
    }
}
