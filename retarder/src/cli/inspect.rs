//! Inspection of unknown logs, and the options that state how a log is read.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use recording::PressureReference;

use super::JsonArg;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder inspect bench.csv
  retarder inspect bench.csv --pressure gauge --out my-columns.toml
  retarder inspect *.mf4
  retarder inspect bench.csv --json | jq '.logs[0].columns[] | {key, signal, unit, reason}'
  zcat bench.csv.gz | retarder inspect -
  retarder compare bench.csv --mapping my-columns.toml

Shows the format of each log, its rows, and for each column or channel rate, missing cells, range, and the
guess of signal and unit with its reason. The proposed mapping is tried on the log before it is shown.
Exit status: 0 the log can be used with the mapping, 1 a needed signal is missing or a row is refused,
2 a question is open, or could not run.")]
pub(crate) struct InspectArgs {
    /// Log to inspect: CSV, MF4, Parquet or MATLAB; may be repeated; - is the standard input
    #[arg(value_name = "LOG", value_hint = ValueHint::FilePath, required = true)]
    pub(crate) paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) import: ImportArgs,
    /// Write the proposed mapping to this TOML file instead of showing it; several logs need the same one
    #[arg(long, value_name = "MAPPING.toml", value_hint = ValueHint::FilePath)]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

/// Maximum number of rows of a log that are skipped; each is listed.
pub(crate) const SKIPPED_MAX: u64 = 1000;

#[derive(Debug, Clone, Args)]
pub(crate) struct ImportArgs {
    /// TOML file that maps columns or channels without standard names to signals and units; `retarder inspect`
    /// proposes one
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) mapping: Option<PathBuf>,
    /// Reference of pressures whose unit states none, such as bar; a unit that states its reference keeps it
    #[arg(long, value_name = "REFERENCE")]
    pressure: Option<Pressure>,
    /// Skip and list up to N rows of a CSV log that cannot be read, such as one with a text among its numbers
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, value_parser = clap::value_parser!(u64).range(0..=SKIPPED_MAX))]
    pub(crate) skip_bad_rows: u64,
}

impl ImportArgs {
    /// Returns the reference of pressures whose unit states none.
    pub(crate) fn reference(&self) -> Option<PressureReference> {
        self.pressure.map(|pressure| match pressure {
            Pressure::Gauge => PressureReference::Gauge,
            Pressure::Absolute => PressureReference::Absolute,
        })
    }

    /// Returns `gauge` or `absolute`, if given.
    pub(crate) fn pressure(&self) -> Option<&'static str> {
        self.reference().map(reference_name)
    }
}

/// Returns the word for a reference on the command line.
pub(crate) fn reference_name(reference: PressureReference) -> &'static str {
    match reference {
        PressureReference::Gauge => "gauge",
        PressureReference::Absolute => "absolute",
    }
}

/// Reference of a pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Pressure {
    /// Relative to the atmosphere
    Gauge,
    /// Relative to vacuum
    Absolute,
}
