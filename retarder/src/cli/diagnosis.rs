//! Commands that find missing effects and wrong parameters of a model.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::{Assignment, HtmlArg, ImportArgs, JsonArg, PlantArgs, assignment};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder diagnose --log bench.csv
  retarder diagnose --plant my-plant.toml --log bench.csv --check other.csv --html diagnosis.html
  retarder diagnose --log cold.csv --log warm.csv --json | jq '.verdict, .effects'

Needs logs of pressure, coil currents or both; several logs of one rig are fitted together. Without
--check, every third of twelve blocks of each log is validation data. Ctrl-C stops the command; it
then leaves no file.
Exit status: 0 no detectable effect is missing, 1 an effect is missing, 2 could not run,
3 no effect is missing, but a value of the plant file is wrong.")]
pub(crate) struct DiagnoseArgs {
    #[command(flatten)]
    pub(crate) logs: LogsArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Write the plant to this file with the missing flow as an effect of your own, if a flow that depends on the
    /// chamber pressure remains
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) missing_flow: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) html: HtmlArg,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder refine --plant my-plant.toml --log bench.csv --check other.csv --out fitted.toml
  retarder refine --log bench.csv --free coil --fix chamber.volume_m3 --out fitted.toml
  retarder refine --log bench.csv --add chamber_leak --out refined.toml
  retarder refine --plant my-plant.toml --log bench.csv --check other.csv --add chamber_leak:laminar --add coil_heating --out refined.toml
  retarder compare --plant refined.toml --log other.csv

Without --add: estimates the ordinary parameters, such as discharge, volume, preload and coil, and the sizes
of the effects in the plant file. A start value may be far off: the plant file, --free and --fix give the
range of each parameter. With --add: adds the effects and fits them together with the ordinary parameters,
which stay within their tolerances. `retarder parameters` lists parameters and effects.
Exit status: 0 the plant file is written, 2 could not run.")]
pub(crate) struct RefineArgs {
    #[command(flatten)]
    pub(crate) logs: LogsArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Effect of the library to add, with a variant of its law; without VARIANT the best fit is used. May be repeated.
    /// Without this option the ordinary parameters are estimated
    #[arg(long, value_name = "EFFECT[:VARIANT]")]
    pub(crate) add: Vec<String>,
    /// Write the refined plant to this file; - is the standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
pub(crate) struct KnowledgeArgs {
    /// Estimate a parameter, those of a table (`coil`) or `all`, within LOW to HIGH; without a range, within the
    /// usual error of a first plant file. May be repeated
    #[arg(long, value_name = "KEY[=LOW..HIGH]", value_parser = freed)]
    pub(crate) free: Vec<Freed>,
    /// Keep a parameter, those of a table or `all` at the values of the plant file; may be repeated
    #[arg(long, value_name = "KEY")]
    pub(crate) fix: Vec<String>,
}

/// Argument of `--free`: parameters and their range.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Freed {
    pub(crate) what: String,
    pub(crate) range: Option<(f64, f64)>,
}

fn freed(text: &str) -> Result<Freed, String> {
    let Some((what, range)) = text.split_once('=') else {
        return Ok(Freed {
            what: text.to_owned(),
            range: None,
        });
    };
    let ends = range.split_once("..");
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|end| end.is_finite())
    };
    let ends = ends.and_then(|(low, high)| number(low).zip(number(high)));
    match ends {
        Some(range) => Ok(Freed {
            what: what.trim().to_owned(),
            range: Some(range),
        }),
        None => Err(format!(
            "`{range}` is no range; write two numbers, LOW..HIGH"
        )),
    }
}

#[derive(Debug, Args)]
pub(crate) struct LogsArgs {
    #[command(flatten)]
    pub(crate) knowledge: KnowledgeArgs,
    /// Bench log to fit: CSV with units in the header (`p_ch_bar_gauge`), MF4, Parquet or MATLAB; may be repeated
    #[arg(value_name = "LOG", value_hint = ValueHint::FilePath, required_unless_present = "log")]
    paths: Vec<PathBuf>,
    /// Bench log to fit, the same as LOG; may be repeated
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    log: Vec<PathBuf>,
    /// Log of the same rig for validation; it is not fitted. May be repeated
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) check: Vec<PathBuf>,
    /// Error to ignore, rms in bar, mA or K: a model error up to it counts as noise; may be repeated
    #[arg(long, value_name = "SIGNAL=RMS", value_parser = assignment)]
    pub(crate) need: Vec<Assignment>,
    #[command(flatten)]
    pub(crate) import: ImportArgs,
}

impl LogsArgs {
    /// Returns the logs to fit, given as LOG or by --log.
    pub(crate) fn logs(&self) -> Vec<PathBuf> {
        self.paths.iter().chain(&self.log).cloned().collect()
    }
}
