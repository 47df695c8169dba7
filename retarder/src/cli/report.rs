//! Report of a whole session.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};

use super::{
    ConditionArgs, ControllerArg, DEFAULT_SCENARIO, LogsArgs, PlantArgs, RequirementsArg,
    scenario_names,
};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder report --log bench.csv
  retarder report --plant my-plant.toml --log bench.csv --check other.csv --out week-12.html
  retarder report --log bench.csv --without diagnosis --rigs 100

The report is one self-contained file: logs, plant, comparison of the model with each log, diagnosis,
and the closed loop on the plant and, if effects are missing, on the plant with them.
Exit status: 0 the model is within tolerance, no effect is missing and the loop meets its
requirements, 1 at least one of these fails, 2 could not run or could not decide.")]
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
    /// Number of additional rigs for the loop, as in `control`
    #[arg(long, value_name = "COUNT", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    pub(crate) rigs: u32,
    #[command(flatten)]
    pub(crate) conditions: ConditionArgs,
    #[command(flatten)]
    pub(crate) requirements: RequirementsArg,
    /// Leave a part out; may be repeated
    #[arg(long, value_name = "PART")]
    pub(crate) without: Vec<ReportPart>,
    /// Write the report to this file; - is the standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, default_value = "report.html")]
    pub(crate) out: PathBuf,
}

/// Part of the report that takes long.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReportPart {
    /// Diagnosis of the missing effect
    Diagnosis,
    /// The closed loop
    Control,
}
