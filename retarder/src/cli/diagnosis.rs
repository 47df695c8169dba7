//! Commands that find what a model lacks.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::{HtmlArg, JsonArg, PlantArgs};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder diagnose --log bench.csv
  retarder diagnose --plant my-plant.toml --log bench.csv --check other.csv --html diagnosis.html
  retarder diagnose --log cold.csv --log warm.csv --json | jq '.verdict, .effects'

Pressure, coil currents or both; several logs of one rig are fitted at once. Without --check, every
third of twelve blocks of each log is held out. Ctrl-C stops it and leaves no file behind.
Exit status: 0 nothing detectable is missing, 1 something is missing, 2 could not run.")]
pub(crate) struct DiagnoseArgs {
    #[command(flatten)]
    pub(crate) logs: LogsArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    #[command(flatten)]
    pub(crate) html: HtmlArg,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder refine --log bench.csv --add chamber_leak --out refined.toml
  retarder refine --plant my-plant.toml --log bench.csv --check other.csv --add chamber_leak:laminar --add coil_heating --out refined.toml
  retarder compare --plant refined.toml --log other.csv

The effects and what differs from rig to rig are fitted together. `retarder parameters` lists the
effects.
Exit status: 0 the plant file is written, 2 could not run.")]
pub(crate) struct RefineArgs {
    #[command(flatten)]
    pub(crate) logs: LogsArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Effect of the library to add, with the form of its law or else the one that fits best; may be repeated
    #[arg(long, value_name = "EFFECT[:VARIANT]", required = true)]
    pub(crate) add: Vec<String>,
    /// Write the refined plant to this file; - is the standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
pub(crate) struct LogsArgs {
    /// Bench log to fit, CSV with units in the header (`p_ch_bar_gauge`) or MF4; may be repeated
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, required = true)]
    pub(crate) log: Vec<PathBuf>,
    /// Log of the same rig that judges and is not fitted; may be repeated
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) check: Vec<PathBuf>,
    /// TOML file that maps the columns of logs that do not explain themselves
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) mapping: Option<PathBuf>,
}
