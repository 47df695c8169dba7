//! The report of a whole session.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};

use super::{ControllerArg, DEFAULT_SCENARIO, LogsArgs, PlantArgs, scenario_names};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder report --log bench.csv
  retarder report --plant my-plant.toml --log bench.csv --check other.csv --out week-12.html
  retarder report --log bench.csv --without diagnosis --rigs 100

One file that needs no other: the logs, the plant, model against measurement for each log, which
effect is missing, and the closed loop on the plant, with the missing effects too where some are found.
Exit status: 0 the model holds, nothing is missing and the loop keeps its promises, 1 not all of it,
2 could not run or tell.")]
pub(crate) struct ReportArgs {
    #[command(flatten)]
    pub(crate) logs: LogsArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    #[command(flatten)]
    pub(crate) controller: ControllerArg,
    /// Built-in scenario of the closed loop: reference profile and start
    #[arg(long, value_name = "NAME", default_value = DEFAULT_SCENARIO, value_parser = scenario_names())]
    pub(crate) scenario: String,
    /// Run the loop on this many more rigs, scattered about the plant as valves are
    #[arg(long, value_name = "COUNT", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    pub(crate) rigs: u32,
    /// Leave a part out; may be repeated
    #[arg(long, value_name = "PART")]
    pub(crate) without: Vec<ReportPart>,
    /// Write the report to this file; - is the standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, default_value = "report.html")]
    pub(crate) out: PathBuf,
}

/// A part of the report that takes its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReportPart {
    /// Which effect is missing
    Diagnosis,
    /// The closed loop
    Control,
}
