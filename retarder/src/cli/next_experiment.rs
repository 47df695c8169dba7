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

Each effect is fitted to the log; manoeuvres within the limits are ranked by how far apart they
would take the effects, when all that can be refitted has been. With --determine, they are ranked by
the number of parameters that they determine; the plant file gives the present knowledge. `simulate`
and a rig take the duty cycles of the best one at once.
Exit status: 0 the best manoeuvre tells the effects apart, or determines all of the parameters;
1 none within the limits does; 2 could not run.")]
pub(crate) struct NextExperimentArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    #[command(flatten)]
    pub(crate) knowledge: KnowledgeArgs,
    /// Effect of the library that may be what is missing
    #[arg(
        long,
        value_name = "EFFECT",
        requires = "and",
        required_unless_present_any = ["for_effect", "determine"]
    )]
    pub(crate) between: Option<String>,
    /// Effect that may be it as well; may be repeated
    #[arg(long, value_name = "EFFECT", requires = "between")]
    pub(crate) and: Vec<String>,
    /// Effect of typical size that the log would not have shown
    #[arg(long = "for", value_name = "EFFECT", conflicts_with = "between")]
    pub(crate) for_effect: Option<String>,
    /// Parameter to be determined, those of a table (`coil`) or `all` that `refine` estimates; may be repeated
    #[arg(long, value_name = "KEY", conflicts_with_all = ["between", "for_effect"])]
    pub(crate) determine: Vec<String>,
    /// Longest time, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    pub(crate) duration: f64,
    /// Highest chamber pressure, bar gauge; without it nine tenths of the supply pressure
    #[arg(long, value_name = "BAR", value_parser = bar)]
    pub(crate) max_bar: Option<f64>,
    /// Highest duty cycle, %
    #[arg(long, value_name = "PCT", default_value_t = 100.0, value_parser = percent)]
    pub(crate) max_duty: f64,
    /// Write the duty cycles of the best manoeuvre to this CSV file; - is the standard output
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
