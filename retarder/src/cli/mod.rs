//! Commands and options of the command line. Each option is defined once.

mod control;
mod device;
mod diagnosis;
mod inspect;
mod merge_rigs;
mod next_experiment;
mod report;
mod schema;

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueHint};
use clap_complete::Shell;
use hil_harness::gain_search::StartingPoint;

use crate::targets::Existing;

pub(crate) use control::{
    ConditionArgs, ControlArgs, DEFAULT_SCENARIO, RequirementsArg, scenario_names,
};
pub(crate) use device::{
    BlackBoxArgs, CalibrateArgs, CalibrateCommand, MeasureArgs, ReadArgs, WriteArgs,
};
pub(crate) use diagnosis::{DiagnoseArgs, Freed, KnowledgeArgs, LogsArgs, RefineArgs};
pub(crate) use inspect::{ImportArgs, InspectArgs, SKIPPED_MAX, reference_name};
pub(crate) use merge_rigs::MergeRigsArgs;
pub(crate) use next_experiment::NextExperimentArgs;
pub(crate) use report::{ReportArgs, ReportPart};
pub(crate) use schema::SchemaName;

/// Model-based control of two on/off solenoid valves: simulate the plant, compare the model with a bench log, find
/// missing physical effects, test the closed loop.
///
/// Without a command: run a demo on a bundled bench log and write its report to report.html.
#[derive(Debug, Parser)]
#[command(name = "retarder", version, after_help = TOUR_EXAMPLES, max_term_width = 110)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Refuse to replace files; without this option an output replaces an older file of its name
    #[arg(long, global = true)]
    no_clobber: bool,
}

impl Cli {
    /// Returns the treatment of files that have the name of an output.
    pub(crate) fn existing(&self) -> Existing {
        match self.no_clobber {
            true => Existing::Keep,
            false => Existing::Replace,
        }
    }
}

const TOUR_EXAMPLES: &str = "\
Examples:
  retarder                                                   run the demo
  retarder inspect bench.csv                                 list the columns of a log, and map them
  retarder compare bench.csv                                 compare the nominal model with a log
  retarder parameters --toml > my-plant.toml                 write a plant file to start from
  retarder compare bench.csv --plant my-plant.toml
  retarder diagnose bench.csv --plant my-plant.toml          find the missing physical effect
  retarder control --plant my-plant.toml                     check the closed loop
  retarder serve                                             work in the browser

Exit status: 0 pass, 1 fail, 2 could not run or could not decide, 3 a value of the plant file is
wrong.
Colours: NO_COLOR=1 turns them off, CLICOLOR_FORCE=1 on. COLUMNS sets the width of tables and plots.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List the columns of an unknown log, guess their signals, and propose a mapping
    Inspect(InspectArgs),
    /// Simulate the model with the duty cycles of a log and write a recording
    Simulate(SimulateArgs),
    /// Compare the model with a measurement: size and place of the error
    Compare(CompareArgs),
    /// Find the physical effect that is missing in the model of a bench log
    Diagnose(DiagnoseArgs),
    /// Estimate the parameters of a plant from bench logs, or add effects to it
    Refine(RefineArgs),
    /// Plan an experiment that distinguishes effects or determines parameters
    NextExperiment(NextExperimentArgs),
    /// Run the closed loop on the model and check its requirements
    Control(ControlArgs),
    /// Merge the tables of rigs that the shards of a batch wrote
    MergeRigs(MergeRigsArgs),
    /// Write a controller file with the duty limits and nominal values of a plant
    Tune(TuneArgs),
    /// Write one HTML report with comparison, diagnosis and closed loop
    Report(ReportArgs),
    /// Read the black box of a device: the last seconds before its first fault
    #[command(name = "blackbox")]
    BlackBox(BlackBoxArgs),
    /// Read, change and save the settings of a running device, and measure its signals
    Calibrate(CalibrateArgs),
    /// Compare the measured figures of the thesis with simulated ones
    Thesis(ThesisArgs),
    /// List the parameters of a plant file: value, unit, range, meaning, uncertainty, source
    Parameters(ParametersArgs),
    /// List the settings of a controller file: value and meaning
    Settings(SettingsArgs),
    /// Serve the workbench as a page in the browser, on localhost only
    Serve(ServeArgs),
    /// Run the work of one browser tab; `serve` starts it
    #[command(hide = true)]
    Tab(TabArgs),
    /// Print the JSON Schema of a result
    #[command(after_help = "Example:\n  retarder schema comparison > comparison.schema.json")]
    Schema {
        /// Name of the result
        result: SchemaName,
    },
    /// Print completions for a shell
    #[command(after_help = COMPLETION_EXAMPLES)]
    Completions {
        /// Name of the shell: bash, elvish, fish, powershell or zsh
        shell: Shell,
    },
}

const COMPLETION_EXAMPLES: &str = "\
Examples:
  retarder completions bash > ~/.local/share/bash-completion/completions/retarder
  retarder completions zsh > ~/.zfunc/_retarder
  retarder completions fish > ~/.config/fish/completions/retarder.fish";

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder simulate --log bench.csv --out model.csv
  retarder simulate --log bench.mf4 --out model.mf4
  retarder simulate --log bench.csv --set gas.supply_pressure_bar_gauge=8.0 | head
  retarder simulate --log next.csv --start p_ch=5.2 --out model.csv
  zcat long.csv.gz | retarder simulate --log - --out model.csv --json")]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Initial state: p_ch in bar gauge, t_gas in K; without p_ch the first measured pressure, or ambient pressure
    #[arg(long, value_name = "SIGNAL=VALUE", value_parser = assignment)]
    pub(crate) start: Vec<Assignment>,
    #[command(flatten)]
    pub(crate) out: OutArg,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder compare --log bench.csv
  retarder compare --plant my-plant.toml --log bench.csv --html comparison.html
  retarder compare --log bench.csv --set chamber.volume_m3=80e-6 --signal i_fill
  retarder compare --log bench.csv --allow 3 --tolerance p_ch=0.05 --json | jq .verdict

Exit status: 0 within tolerance, 1 outside tolerance, 2 could not run or could not decide.")]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Accept a signal if its free-run rms error is at most this many times its noise floor
    #[arg(long, value_name = "MULTIPLES", default_value_t = 1.5)]
    pub(crate) allow: f64,
    /// Accept a signal if its free-run rms error is at most this, in bar, mA or mm, at any noise floor
    #[arg(long, value_name = "SIGNAL=RMS", value_parser = assignment)]
    pub(crate) tolerance: Vec<Assignment>,
    /// Show regimes and plots of this signal, not of the one with the largest error
    #[arg(long, value_name = "NAME")]
    pub(crate) signal: Option<String>,
    #[command(flatten)]
    pub(crate) html: HtmlArg,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder thesis
  retarder thesis --plant my-plant.toml --html thesis.html --json thesis.json
  retarder thesis --explain                  find the effects that explain the filling times

Exit status: 0 every binding figure is within its tolerance (with --explain: at least one effect
brings the filling times within tolerance), 1 at least one is not (with --explain: no effect does),
2 could not run.")]
pub(crate) struct ThesisArgs {
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Fit series_restriction, supply_line_droop and critical_ratio to the complete filling times of the large orifices
    #[arg(long, conflicts_with = "html")]
    pub(crate) explain: bool,
    #[command(flatten)]
    pub(crate) html: HtmlArg,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder parameters
  retarder parameters --toml > my-plant.toml      a plant file with a place for the uncertainty of each value
  retarder parameters --from-datasheet my-rig.toml > my-plant.toml     a plant file from data sheets and a tape measure
  retarder parameters --from-datasheet my-rig.toml --ask > my-plant.toml     asks for the values that my-rig.toml lacks
  retarder parameters --plant my-plant.toml
  retarder parameters --plant my-plant.toml --set coil.resistance_20c_ohm=80 --toml > warmer.toml")]
pub(crate) struct ParametersArgs {
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Write the plant file of a rig from a TOML file with its values in the units of data sheets
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = ["plant", "set"])]
    pub(crate) from_datasheet: Option<PathBuf>,
    /// Ask for each value that the datasheet file lacks, and add the answers to it; it need not exist yet
    #[arg(long, requires = "from_datasheet")]
    pub(crate) ask: bool,
    #[command(flatten)]
    pub(crate) toml: TomlArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder settings
  retarder settings --controller thesis --toml > my-controller.toml
  retarder settings --requirements > my-requirements.toml")]
pub(crate) struct SettingsArgs {
    #[command(flatten)]
    pub(crate) controller: ControllerArg,
    /// Print the requirements of the thesis as a requirements file to start from
    #[arg(long, conflicts_with_all = ["controller", "toml"])]
    pub(crate) requirements: bool,
    #[command(flatten)]
    pub(crate) toml: TomlArg,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder tune --plant my-plant.toml > my-controller.toml
  retarder tune --plant my-plant.toml --gains relay > my-controller.toml
  retarder tune --plant my-plant.toml --search --out my-controller.toml --html gains.html
  retarder control --plant my-plant.toml --controller my-controller.toml --rigs 20

The experiments of section 4.1 of the thesis run on the model: the lowest duty cycle that opens
each valve, with and without the supply pressure across it, and the lowest that keeps it open.
Supply voltage, coil resistance, supply pressure, orifice and rates are those of the plant. Gains
and times stay those of the controller that is tuned, unless --gains or --search finds others.

--search runs each candidate through both timed passages and all steps of the operating range, on
scattered rigs under the supply voltages and temperatures of vehicles. Its table and its picture
show the trade-off of settling time, overshoot and lifts. The controller file has the candidate that
costs least on further rigs; the table says what the cost is. The same search with --choose NUMBER
writes another one.")]
pub(crate) struct TuneArgs {
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    #[command(flatten)]
    pub(crate) controller: ControllerArg,
    /// Gains from an experiment on the model: `relay` (Åström and Hägglund) or `ziegler-nichols` (reaction curve)
    #[arg(long, value_name = "METHOD", value_parser = starting_points(), conflicts_with = "search")]
    pub(crate) gains: Option<StartingPoint>,
    /// Search gains with this many candidates, both experiments included [without COUNT: 120]
    #[arg(long, value_name = "COUNT", num_args = 0..=1, default_missing_value = "120", value_parser = clap::value_parser!(u32).range(4..=100_000))]
    pub(crate) search: Option<u32>,
    /// Number of scattered rigs for each candidate
    #[arg(long, value_name = "COUNT", default_value_t = 8, requires = "search", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) rigs: u32,
    /// Seed of the search: rigs, noise and candidates
    #[arg(long, value_name = "NUMBER", default_value_t = 1, requires = "search")]
    pub(crate) seed: u64,
    /// Number of the candidate for the controller file, from the table of the same search
    #[arg(long, value_name = "NUMBER", requires = "search", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) choose: Option<u32>,
    #[command(flatten)]
    pub(crate) requirements: RequirementsArg,
    /// Write the controller file here, and print the table; without this option, print the controller file
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) out: Option<PathBuf>,
    /// Write the table and the picture of a search as a self-contained HTML report
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "search")]
    pub(crate) html: Option<PathBuf>,
}

/// Reads the name of an experiment for gains.
fn starting_points() -> impl TypedValueParser<Value = StartingPoint> {
    PossibleValuesParser::new(StartingPoint::ALL.map(StartingPoint::name)).map(|name| {
        let mut all = StartingPoint::ALL.into_iter();
        let named = all.find(|method| method.name() == name);
        named.unwrap_or_else(|| unreachable!("clap has checked the name"))
    })
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder serve
  retarder serve --project bench-week-12 --port 8080

Open the printed address in one browser; it changes with every start. Ctrl-C ends the server.")]
pub(crate) struct ServeArgs {
    /// Folder for logs and projects; the next start finds them there
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath, default_value = "retarder-project")]
    pub(crate) project: PathBuf,
    /// Port on the loopback interface; without this option 7474, or a free port if 7474 is in use
    #[arg(long, value_name = "PORT", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) port: Option<u16>,
    /// Memory limit of one browser tab, MiB; work that needs more is aborted, and the page stays usable
    #[arg(long, value_name = "MIB", default_value_t = workbench::Worker::MEMORY_BYTES >> 20, value_parser = clap::value_parser!(u64).range(256..=1 << 20))]
    pub(crate) memory: u64,
}

#[derive(Debug, Args)]
pub(crate) struct TabArgs {
    #[arg(value_hint = ValueHint::DirPath)]
    pub(crate) project: PathBuf,
    pub(crate) memory_bytes: u64,
}

#[derive(Debug, Args)]
pub(crate) struct PlantArgs {
    /// Plant file; without this option the thesis model (see `retarder parameters`)
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) plant: Option<PathBuf>,
    /// Change a parameter of the plant; may be repeated
    #[arg(long, value_name = "SECTION.KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<Assignment>,
}

#[derive(Debug, Args)]
pub(crate) struct LogArgs {
    /// Bench log: CSV with units in the header (`p_ch_bar_gauge`), MF4, Parquet or MATLAB; - is the standard input
    #[arg(value_name = "LOG", value_hint = ValueHint::FilePath, required_unless_present = "log", conflicts_with = "log")]
    path: Option<PathBuf>,
    /// Bench log, the same as LOG
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    log: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) import: ImportArgs,
}

impl LogArgs {
    /// Returns the log, given as LOG or by --log.
    pub(crate) fn log(&self) -> &Path {
        let given = self.path.as_deref().or(self.log.as_deref());
        given.unwrap_or_else(|| unreachable!("clap requires one of them"))
    }
}

#[derive(Debug, Args)]
pub(crate) struct ControllerArg {
    /// Controller file, or `thesis`, `recommended` or `pulses` for a bundled controller
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, default_value = "recommended")]
    pub(crate) controller: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct OutArg {
    /// Write the recording to this CSV file; `simulate` and `control` write MF4, Parquet, MATLAB v5 or HDF5 (MATLAB v7.3)
    /// if the name ends in .mf4, .parquet, .mat or .h5
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct HtmlArg {
    /// Write a self-contained HTML report with plots; - is the standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) html: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct JsonArg {
    /// Write the result as JSON (see `retarder schema`) to FILE; without FILE, print it in place of the text
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, num_args = 0..=1, default_missing_value = "-")]
    pub(crate) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct TomlArg {
    /// Print a TOML file to start from
    #[arg(long)]
    pub(crate) toml: bool,
}

/// Argument of the form `name=number`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assignment {
    pub(crate) name: String,
    pub(crate) value: f64,
}

fn assignment(text: &str) -> Result<Assignment, String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("expected NAME=VALUE, such as chamber.volume_m3=75e-6")?;
    let value = value.trim().parse().map_err(|_| {
        format!("`{value}` is no number; write digits with a decimal point, such as 8.4")
    })?;
    Ok(Assignment {
        name: name.trim().to_owned(),
        value,
    })
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn an_assignment_has_a_name_and_a_number() {
        let found = assignment("chamber.volume_m3 = 75e-6").unwrap();
        assert_eq!(
            (found.name.as_str(), found.value),
            ("chamber.volume_m3", 75e-6)
        );
        assert!(
            assignment("chamber.volume_m3")
                .unwrap_err()
                .contains("NAME=VALUE")
        );
        assert!(assignment("a.b=8,4").unwrap_err().contains("`8,4`"));
    }
}
