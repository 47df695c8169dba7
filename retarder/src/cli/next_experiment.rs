//! The command that plans the next experiment.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use model_lab::diagnosis::next_experiment::Limits;

use super::{JsonArg, KnowledgeArgs, LogArgs, PlantArgs};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder next-experiment --log bench.csv --between sensor_lag --and dead_volume --out next.csv
  retarder next-experiment --log bench.csv --for drain_back_pressure --max-bar 6 --out next.csv
  retarder next-experiment --plant fitted.toml --log bench.csv --determine coil --out next.csv
  retarder simulate --log next.csv --out model.csv

Each effect is fitted to the log. Test signals within the limits are ranked by the difference between
the effects' predictions, after all other parameters are fitted again. With --determine, they are
ranked by the number of parameters that they determine; the plant file gives the present uncertainty.
`simulate` and a rig can use the duty cycles of the best test signal directly.
Exit status: 0 the best test signal distinguishes the effects, or determines all of the parameters;
1 no test signal within the limits does; 2 could not run.")]
pub(crate) struct NextExperimentArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    #[command(flatten)]
    pub(crate) knowledge: KnowledgeArgs,
    /// Effect of the library that may be missing
    #[arg(
        long,
        value_name = "EFFECT",
        requires = "and",
        required_unless_present_any = ["for_effect", "determine"]
    )]
    pub(crate) between: Option<String>,
    /// Another effect that may be missing instead; may be repeated
    #[arg(long, value_name = "EFFECT", requires = "between")]
    pub(crate) and: Vec<String>,
    /// Effect whose typical size is below the detection limit of the log
    #[arg(long = "for", value_name = "EFFECT", conflicts_with = "between")]
    pub(crate) for_effect: Option<String>,
    /// Parameter to determine, those of a table (`coil`), or `all` that `refine` estimates; may be repeated
    #[arg(long, value_name = "KEY", conflicts_with_all = ["between", "for_effect"])]
    pub(crate) determine: Vec<String>,
    /// Longest duration, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    pub(crate) duration: f64,
    /// Highest chamber pressure, bar gauge; without this option 90 % of the supply pressure
    #[arg(long, value_name = "BAR", value_parser = bar)]
    pub(crate) max_bar: Option<f64>,
    /// Highest duty cycle, %
    #[arg(long, value_name = "PCT", default_value_t = 100.0, value_parser = percent)]
    pub(crate) max_duty: f64,
    /// Write the duty cycles of the best test signal to this CSV file; - is the standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

fn seconds(text: &str) -> Result<f64, String> {
    within(text, Limits::LONGEST_S)
}

fn bar(text: &str) -> Result<f64, String> {
    within(text, Limits::HIGHEST_BAR)
}

fn percent(text: &str) -> Result<f64, String> {
    within(text, 100.0)
}

fn within(text: &str, most: f64) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value > 0.0 && value <= most {
        Ok(value)
    } else {
        Err(format!("{value} is not above 0 and at most {most}"))
    }
}
