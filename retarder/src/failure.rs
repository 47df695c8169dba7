//! Reasons why a command could not run: what was wrong, where, and what to do.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use ecu::calibration::SETTINGS;
use hil_harness::RunError;
use hil_harness::checks::JudgeError;
use hil_harness::controller_file::ControllerFileError;
use hil_harness::duty_limits::NoDutyLimit;
use hil_harness::gain_search::SearchError;
use hil_harness::image::ImageError;
use hil_harness::link::{LinkError, SerialError};
use hil_harness::monte_carlo::{MergeError, MonteCarloError};
#[cfg(unix)]
use hil_harness::qemu::QemuError;
use hil_harness::reference_profile::ProfileError;
use hil_harness::requirement_file::RequirementFileError;
use hil_harness::rigs::RigError;
use hil_harness::signals;
use hil_protocol::MEASURED_MAX;
use model_lab::diagnosis::{DiagnoseError, KnowledgeError};
use model_lab::{CompareError, StartError};
use plant_sim::ParameterError;
use plant_sim::parameters::Part;
use plant_sim::replay::ReplayError;
use recording::LogError;
use recording::csv::{CsvError, MappingError, WriteError};

use crate::shell::quoted;

/// Parts of the codes of errors that a mapping solves.
const COLUMN_CODES: [&str; 12] = [
    "-UNIT-",
    "-HEADER",
    "-NAME",
    "-NO-COLUMN",
    "-TWO-COLUMNS",
    "-UNMAPPED",
    "-DELIMITER",
    "-DECIMAL",
    "-THOUSANDS",
    "-NO-SIGNAL",
    "-SCALE",
    "-MAPPED-",
];

/// Reason for a missing result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("{}: {error}; check the name and the rights", path.display())]
    Read { path: PathBuf, error: io::Error },
    #[error("the answers ended before all questions; those that were given are in {}: run the same command again", path.display())]
    AnswersEnded { path: PathBuf },
    #[error("--controller {}: there is no such file, and the bundled controllers are {}", path.display(), bundled.join(", "))]
    NoController {
        path: PathBuf,
        bundled: [&'static str; 3],
    },
    #[error("{plant}: {error}")]
    NotTuned { plant: String, error: NoDutyLimit },
    #[error("{controller}, {plant}: {error}")]
    NoGains {
        controller: String,
        plant: String,
        error: Box<SearchError>,
    },
    #[error("{}: not UTF-8 text; save it as UTF-8", path.display())]
    NotText { path: PathBuf },
    #[error("{}: larger than the {limit} bytes of any file of this kind; is it the right one?", path.display())]
    TooLarge { path: PathBuf, limit: u64 },
    #[error(transparent)]
    Serve(#[from] workbench::ServeError),
    #[error("the program's own file: {0}; start it by its full path")]
    OwnProgram(io::Error),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error("{error}\n`retarder inspect {}` lists the columns and proposes a mapping", quoted(&path.display().to_string()))]
    UnknownColumns { path: PathBuf, error: LogError },
    #[error(
        "{error}, or state it for the whole log: --pressure gauge, or --pressure absolute\n`retarder inspect {}` shows which one fits the values", quoted(&path.display().to_string())
    )]
    OpenReference { path: PathBuf, error: LogError },
    #[error(
        "{}: --plant expects a plant file (TOML), and this is a log. Corrected command:\n  {command}", path.display()
    )]
    LogAsPlant { path: PathBuf, command: String },
    #[error(
        "{}: --plant expects a plant file, and this file has the keys of a data sheet. Write the plant file from it first:\n  retarder parameters --from-datasheet {} > my-plant.toml", path.display(), quoted(&path.display().to_string())
    )]
    DatasheetAsPlant { path: PathBuf },
    #[error(
        "{}: a log is expected (CSV, MF4, Parquet or MATLAB), and this is a {kind} (TOML). Corrected command:\n  {command}", path.display()
    )]
    TomlAsLog {
        path: PathBuf,
        kind: &'static str,
        command: String,
    },
    #[error("the standard input cannot be kept for a second reading: {error}; write it to a file")]
    KeepStandardInput { error: io::Error },
    #[error("the standard input is read once; write - once")]
    StandardInputTwice,
    #[error(
        "{} and {}: the logs need different mappings; inspect them one by one", one.display(), other.display()
    )]
    DifferentMappings { one: PathBuf, other: PathBuf },
    #[error(transparent)]
    Mapping(#[from] MappingError),
    #[error("{error}{source_lines}")]
    Plant {
        error: ParameterError,
        source_lines: SourceLines,
    },
    #[error("{error}{source_lines}")]
    Controller {
        error: ControllerFileError,
        source_lines: SourceLines,
    },
    #[error("{error}{source_lines}")]
    Requirements {
        error: RequirementFileError,
        source_lines: SourceLines,
    },
    #[error("--supply-voltage or --coil-temperature: {error}")]
    Condition { error: ParameterError },
    #[error("--set {error}")]
    Set { error: ParameterError },
    #[error("--free or --fix: {error}")]
    Knowledge { error: KnowledgeError },
    #[error(
        "--set {name}: the plant has no [regulating_valve]; add the table to its plant file first"
    )]
    SetAbsent { name: String },
    #[error(
        "--need {name}={value}: an error is positive; give the rms that is of no interest in bar, mA or K, such as p_ch=0.02"
    )]
    NeedOutOfRange { name: String, value: f64 },
    #[error("--need {name}: the logs have no such signal; they have {}", known.join(", "))]
    NeedOfNoSignal { name: String, known: Vec<String> },
    #[error(
        "{plant}: the plant has no {part}; this command needs both valves and the chamber, `simulate` and `compare` do not"
    )]
    PartLeftOut { plant: String, part: Part },
    #[error("{}: {error}", path.display())]
    Reference { path: PathBuf, error: ProfileError },
    #[error("{}: {error}", path.display())]
    Replay { path: PathBuf, error: ReplayError },
    #[error(transparent)]
    Compare(#[from] CompareError),
    #[error("--start: {0}")]
    Start(#[from] StartError),
    #[error(transparent)]
    Diagnose(#[from] DiagnoseError),
    #[error(
        "--add {id} is there more than once; an effect is in a plant once, with one form of its law"
    )]
    AddedTwice { id: String },
    #[error(
        "{plant}: the plant has no {part}, on which the effect `{id}` acts; leave out --add {id}"
    )]
    EffectOnNothing {
        plant: String,
        part: Part,
        id: String,
    },
    #[error("there is no compared signal `{name}`; compared are {compared}")]
    NoSuchSignal { name: String, compared: String },
    #[error(transparent)]
    Image(#[from] ImageError),
    #[cfg(unix)]
    #[error(transparent)]
    Qemu(#[from] QemuError),
    #[cfg(not(unix))]
    #[error(
        "the emulated device needs a Unix; use --dut in-process, or a board with --dut serial:PORT"
    )]
    NoEmulator,
    #[error(transparent)]
    Serial(#[from] SerialError),
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(
        "the device's image {version} has other tables of signals and settings than this program; use the program that came with it"
    )]
    OtherTables { version: String },
    #[error("there is no setting `{name}`{}", alike(name, SETTINGS.iter().map(|setting| setting.name), "retarder calibrate read --dut in-process"))]
    NoSuchSetting { name: String },
    #[error("there is no signal `{name}`{}", alike(name, signals::all().map(|(_, signal)| signal.name), "retarder calibrate signals"))]
    NoSuchDeviceSignal { name: String },
    #[error("`{assignment}`: expected {expected}")]
    SettingValue {
        assignment: String,
        expected: String,
    },
    #[error("the device refuses the settings, and nothing has changed: {said}")]
    SettingsRefused { said: String },
    #[error(
        "{count} signals at once are too many: {MEASURED_MAX} at most; measure the others in another run"
    )]
    TooManySignals { count: usize },
    #[error(
        "the ECU in process has no sample timer: measure on a board (--dut serial:PORT) or on the emulated image (--dut qemu)"
    )]
    NoTimer,
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Judge(#[from] JudgeError),
    #[error(transparent)]
    Rigs(#[from] RigError),
    #[error(transparent)]
    MonteCarlo(#[from] MonteCarloError),
    #[error(transparent)]
    Merge(#[from] MergeError),
    #[error("--rigs-out with 0 rigs: a table needs at least one; give --rigs COUNT")]
    NoRigs,
    #[error(
        "--rigs {count}: {max} at most without --rigs-out, because every verdict is kept in memory; add --rigs-out rigs.parquet"
    )]
    TooManyRigs { count: u32, max: u32 },
    #[error(
        "{}: tables of rigs are written as Parquet; choose a name that ends in .parquet", path.display()
    )]
    OnlyParquet { path: PathBuf },
    #[error("{}: {error}", target(path))]
    Write {
        path: Option<PathBuf>,
        error: WriteError,
    },
    #[error("two results for the standard output; write one of them to a file with {option} FILE")]
    TwoOnStandardOutput { option: String },
    #[error(
        "{}: {output} names the file that {input} reads, and its content would be lost; choose another output", path.display()
    )]
    OutputIsInput {
        path: PathBuf,
        output: String,
        input: String,
    },
    #[error("{}: {one} and {other} name the same file; give each result a file of its own", path.display())]
    OneFileForTwo {
        path: PathBuf,
        one: String,
        other: String,
    },
    #[error("{}: exists, and --no-clobber keeps it; choose another output", path.display())]
    Exists { path: PathBuf },
    #[error(
        "{}: exists and is no report of this program, so it is not replaced; move it away, or {}", path.display(),
        if *is_demo { "start in another folder" } else { "name another file with --out FILE" }
    )]
    NotOurReport { path: PathBuf, is_demo: bool },
    #[error(
        "{}: only recordings of `simulate` and `control` are written as MF4, Parquet or MATLAB; choose a name that ends in .csv", path.display()
    )]
    OnlyCsv { path: PathBuf },
    #[error("interrupted; nothing was written")]
    Interrupted,
    #[error("Ctrl-C cannot be watched for: {0}")]
    Signal(#[from] ctrlc::Error),
}

impl From<CsvError> for Failure {
    fn from(error: CsvError) -> Self {
        Self::Log(error.into())
    }
}

impl Failure {
    /// Creates the failure of a log that could not be read; an inspection helps with its columns.
    pub(crate) fn of_log(path: &Path, error: LogError) -> Self {
        let code = error.code();
        let path = path.to_path_buf();
        match COLUMN_CODES.iter().any(|column| code.contains(column)) {
            _ if code.ends_with("-PRESSURE-REFERENCE") => Self::OpenReference { path, error },
            true => Self::UnknownColumns { path, error },
            false => Self::Log(error),
        }
    }

    /// Creates the failure of the output `path`; `None` is the standard output.
    pub(crate) fn write(path: Option<&Path>, error: impl Into<WriteError>) -> Self {
        Self::Write {
            path: path.map(Path::to_path_buf),
            error: error.into(),
        }
    }

    /// Returns whether the reader closed the standard output, which is not a failure.
    pub(crate) fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Write { path: None, error: WriteError::Io(error) } if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

fn target(path: &Option<PathBuf>) -> String {
    path.as_ref().map_or_else(
        || "standard output".to_owned(),
        |path| path.display().to_string(),
    )
}

/// Returns the names similar to `name`, or the place of the whole list.
fn alike<'a>(name: &str, names: impl Iterator<Item = &'a str>, list: &str) -> String {
    let name = name.to_lowercase();
    let mut letters: Vec<char> = name.chars().collect();
    letters.sort_unstable();
    let is_alike = |other: &str| {
        let mut others: Vec<char> = other.chars().take(letters.len()).collect();
        others.sort_unstable();
        other.contains(&name) || name.contains(other) || others == letters
    };
    let found: Vec<&str> = names.filter(|other| is_alike(other)).take(4).collect();
    match found.as_slice() {
        [] => format!("; `{list}` lists all"),
        found => format!("; did you mean {}?", found.join(", ")),
    }
}

/// Lines of a file that its problems refer to, each with a mark below.
#[derive(Debug, Default)]
pub(crate) struct SourceLines(Vec<(usize, String)>);

/// Number of source lines shown at most.
const LINES_MAX: usize = 5;
/// Longest line shown (characters).
const LINE_LENGTH_MAX: usize = 100;

impl SourceLines {
    /// Returns the lines of `text` with these numbers, from 1.
    pub(crate) fn of(text: &str, numbers: impl Iterator<Item = usize>) -> Self {
        let mut numbers: Vec<usize> = numbers.collect();
        numbers.dedup();
        let line = |number: usize| {
            let line = text.lines().nth(number.checked_sub(1)?)?;
            let line: String = line
                .chars()
                .map(|character| {
                    if character.is_control() {
                        ' '
                    } else {
                        character
                    }
                })
                .take(LINE_LENGTH_MAX)
                .collect();
            Some((number, line))
        };
        Self(
            numbers
                .into_iter()
                .take(LINES_MAX)
                .filter_map(line)
                .collect(),
        )
    }
}

impl fmt::Display for SourceLines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self
            .0
            .iter()
            .map(|(number, _)| number.to_string().len())
            .max();
        let width = width.unwrap_or_default();
        for (number, line) in &self.0 {
            let statement = line.split('#').next().unwrap_or_default().trim_end();
            let indent = statement.len() - statement.trim_start().len();
            let marks = statement.trim_start().chars().count().max(1);
            write!(
                f,
                "\n{:width$} |\n{number:>width$} | {line}\n{:width$} | {:indent$}{}",
                "",
                "",
                "",
                "^".repeat(marks)
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_line_is_marked_without_its_comment() {
        let lines = SourceLines::of(
            "[coil]\n  inductance_h = 440 # datasheet\n",
            [2].into_iter(),
        );
        assert_eq!(
            lines.to_string(),
            "\n  |\n2 |   inductance_h = 440 # datasheet\n  |   ^^^^^^^^^^^^^^^^^^"
        );
    }

    #[test]
    fn lines_that_are_not_there_and_characters_that_a_terminal_obeys_are_left_out() {
        assert_eq!(SourceLines::of("a\n", [0, 7].into_iter()).to_string(), "");
        let hostile = SourceLines::of("a = \u{1b}[31m\n", [1].into_iter()).to_string();
        assert!(!hostile.contains('\u{1b}'), "{hostile:?}");
    }
}
