//! Output of a recording row by row, as CSV or MF4: to the standard output, or to a file that appears when it is
//! complete.

use std::io::{self, BufWriter, StdoutLock};
use std::path::Path;

use recording::csv::{self, Column, Decimals, WriteError};
use recording::{AtomicFile, LogFormat, Provenance, mf4};

use crate::targets::Existing;

/// Destination of the rows.
pub(super) enum RowOutput {
    Standard(csv::Writer<BufWriter<StdoutLock<'static>>>),
    Csv(csv::Writer<AtomicFile>),
    Mf4(mf4::Writer<AtomicFile>),
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
        })
    }

    pub(super) fn write_row(&mut self, time_s: f64, values: &[f64]) -> Result<(), WriteError> {
        match self {
            Self::Standard(writer) => writer.write_row(time_s, values),
            Self::Csv(writer) => writer.write_row(time_s, values),
            Self::Mf4(writer) => writer.write_row(time_s, values),
        }
    }

    /// Makes the file visible under its name.
    pub(super) fn finish(self) -> Result<(), WriteError> {
        match self {
            Self::Standard(writer) => drop(writer.finish()?),
            Self::Csv(writer) => writer.finish()?.commit()?,
            Self::Mf4(writer) => writer.finish()?.commit()?,
        }
        Ok(())
    }
}
