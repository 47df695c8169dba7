//! Files in each other's place: a log or a data sheet given as the plant file, a plant file or a mapping given as a log.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use clap::error::ErrorKind;
use clap::{Arg, ArgAction, Command, CommandFactory as _};
use plant_sim::parameters::is_datasheet_key;
use recording::LogFormat;

use crate::cli::Cli;
use crate::failure::Failure;
use crate::shell::quoted;

/// Number of bytes by which files are distinguished.
const HEAD_BYTES: u64 = 4096;
/// Options whose file is sorted again in a corrected command.
const SORTED: [&str; 4] = ["--plant", "--log", "--check", "--mapping"];

/// Kind of a file, by its beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Log,
    Plant,
    Mapping,
    Unknown,
}

impl Kind {
    fn of(path: &Path) -> Self {
        head_of(path).map_or(Self::Unknown, |head| Self::of_head(&head))
    }

    fn of_head(head: &[u8]) -> Self {
        if LogFormat::of_beginning(head) != LogFormat::Csv {
            return Self::Log;
        }
        let text = String::from_utf8_lossy(head);
        let text = text.trim_start_matches('\u{feff}');
        let lines = text.lines().map(str::trim);
        let mut lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
        let Some(first) = lines.clone().next() else {
            return Self::Unknown;
        };
        let is_table =
            |line: &str| line.starts_with('[') && line.contains(']') && !line.contains([';', '\t']);
        let key = first.split_once('=').map(|(key, _)| key.trim());
        let is_key = |key: &str| {
            let is_letter = |letter: char| letter.is_alphanumeric() || "_.-".contains(letter);
            !key.is_empty() && key.chars().all(is_letter)
        };
        if is_table(first) || key.is_some_and(is_key) {
            let tables = [
                "[time]",
                "[dialect]",
                "[signal",
                "[constant",
                "[rows]",
                "signal.",
            ];
            return match lines.any(|line| tables.iter().any(|table| line.starts_with(table))) {
                true => Self::Mapping,
                false => Self::Plant,
            };
        }
        match first.contains([',', ';', '\t']) {
            true => Self::Log,
            false => Self::Unknown,
        }
    }

    /// Returns the option for a file of this kind.
    fn option(self) -> Option<&'static str> {
        match self {
            Self::Log => Some("--log"),
            Self::Plant => Some("--plant"),
            Self::Mapping => Some("--mapping"),
            Self::Unknown => None,
        }
    }
}

/// Returns the beginning of a file; none if it cannot be read.
fn head_of(path: &Path) -> Option<Vec<u8>> {
    let mut head = Vec::new();
    let is_file = path.metadata().is_ok_and(|metadata| metadata.is_file());
    let read = |file: File| file.take(HEAD_BYTES).read_to_end(&mut head);
    (is_file && File::open(path).and_then(read).is_ok()).then_some(head)
}

/// Returns whether a file begins with keys of a datasheet file: a plant file has its keys in tables.
fn is_datasheet(path: &Path) -> bool {
    let head = head_of(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&head);
    let mut lines = text.lines().take_while(|line| !line.starts_with('['));
    lines.any(|line| {
        let key = line.split_once('=').map(|(key, _)| key.trim());
        key.is_some_and(is_datasheet_key)
    })
}

/// Refuses a log or a data sheet in the place of a plant file, with the corrected command.
pub(crate) fn refuse_as_plant(path: &Path) -> Result<(), Failure> {
    match Kind::of(path) {
        Kind::Plant if is_datasheet(path) => Err(Failure::DatasheetAsPlant {
            path: path.to_path_buf(),
        }),
        Kind::Log => Err(Failure::LogAsPlant {
            path: path.to_path_buf(),
            command: corrected(arguments(), path, &Kind::of),
        }),
        _ => Ok(()),
    }
}

/// Refuses a plant file or a mapping in the place of a log, with the corrected command.
pub(crate) fn refuse_as_log(path: &Path) -> Result<(), Failure> {
    let kind = match Kind::of(path) {
        Kind::Plant => "plant file",
        Kind::Mapping => "mapping",
        Kind::Log | Kind::Unknown => return Ok(()),
    };
    Err(Failure::TomlAsLog {
        path: path.to_path_buf(),
        kind,
        command: corrected(arguments(), path, &Kind::of),
    })
}

/// Returns the reason why a required argument is missing, if a log was given as the plant file.
pub(crate) fn explained(error: &clap::Error) -> Option<Failure> {
    if error.kind() != ErrorKind::MissingRequiredArgument {
        return None;
    }
    let (_, items) = items(arguments());
    let plants = items
        .iter()
        .filter(|item| item.option.as_deref() == Some("--plant"));
    plants
        .into_iter()
        .find_map(|item| refuse_as_plant(Path::new(&item.value)).err())
}

fn arguments() -> Vec<String> {
    let arguments = std::env::args_os().skip(1);
    arguments
        .map(|one| one.to_string_lossy().into_owned())
        .collect()
}

/// Argument of a command line: an option of [`SORTED`] with its value, or any other word.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Item {
    option: Option<String>,
    value: String,
}

/// Splits arguments into the command and its items.
fn items(arguments: Vec<String>) -> (String, Vec<Item>) {
    let mut arguments = arguments.into_iter();
    let command = arguments.next().unwrap_or_default();
    let mut items = Vec::new();
    while let Some(argument) = arguments.next() {
        let (name, value) = match argument.split_once('=') {
            Some((name, value)) => (name.to_owned(), Some(value.to_owned())),
            None => (argument.clone(), None),
        };
        let item = match (SORTED.contains(&&*name), value) {
            (true, value) => Item {
                value: value.or_else(|| arguments.next()).unwrap_or_default(),
                option: Some(name),
            },
            (false, _) => Item {
                option: None,
                value: argument,
            },
        };
        items.push(item);
    }
    (command, items)
}

/// Files that a command takes.
struct Taken {
    options: Vec<String>,
    /// Whether it takes logs without an option.
    logs: bool,
    /// Whether it takes one log only.
    one_log: bool,
}

impl Taken {
    fn by(command: &str) -> Self {
        let whole = Cli::command();
        let arguments = || {
            let command = whole.find_subcommand(command);
            command.into_iter().flat_map(Command::get_arguments)
        };
        Self {
            options: arguments()
                .filter_map(Arg::get_long)
                .map(|name| format!("--{name}"))
                .collect(),
            logs: arguments().any(Arg::is_positional),
            one_log: arguments().any(|one| {
                one.get_long() == Some("log") && matches!(one.get_action(), ArgAction::Set)
            }),
        }
    }

    fn has(&self, option: &str) -> bool {
        self.options.iter().any(|taken| taken == option)
    }
}

/// Returns the command in which each file has the option of its kind; `wrong` is one that does not. A command without an
/// option for a file of this kind gets a placeholder for the file that it needs.
fn corrected(arguments: Vec<String>, wrong: &Path, kind_of: &dyn Fn(&Path) -> Kind) -> String {
    let (command, items) = items(arguments);
    let mut text = format!("retarder {command}");
    let taken = Taken::by(&command);
    let (mut moved, mut has_log) = (String::new(), false);
    let is_at_its_place = |item: &Item| {
        matches!(item.option.as_deref(), None | Some("--log"))
            && kind_of(Path::new(&item.value)) == Kind::Log
    };
    let takes_no_more_logs = taken.one_log && items.iter().any(is_at_its_place);
    for Item { option, value } in items {
        let path = Path::new(&value);
        let is_file = option.is_some() || path == wrong;
        let kind = if is_file {
            kind_of(path)
        } else {
            Kind::Unknown
        };
        let fits = match (&option, kind.option()) {
            (Some(option), Some(right)) => {
                option == right || option == "--check" && right == "--log"
            }
            (None, Some(right)) => right == "--log",
            (_, None) => true,
        };
        let shown = quoted(&value);
        let is_log = matches!(option.as_deref(), Some("--log" | "--check"));
        has_log |= is_log && fits || !fits && kind == Kind::Log;
        match (kind.option().filter(|_| !fits), option) {
            (Some(right), _) if taken.has(right) && !(right == "--log" && takes_no_more_logs) => {
                moved += &format!(" {right} {shown}");
            }
            (Some(_), Some(option)) => {
                text += &format!(" {option} {}", option[2..].to_uppercase());
            }
            (Some(_), None) => {}
            (None, Some(option)) => text += &format!(" {option} {shown}"),
            (None, None) => {
                // Another log without an option stays where it is.
                has_log |= kind_of(path) == Kind::Log;
                text += &format!(" {shown}");
            }
        }
    }
    text += &moved;
    match (has_log, taken.has("--log"), taken.logs) {
        (false, true, _) => text + " --log LOG",
        (false, false, true) => text + " LOG",
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_distinguished_by_their_beginning() {
        let kind = |text: &str| Kind::of_head(text.as_bytes());
        assert_eq!(kind("MDF     4.10"), Kind::Log);
        assert_eq!(kind("PAR1\u{15}\u{4}"), Kind::Log);
        assert_eq!(kind("MATLAB 5.0 MAT-file, Platform: posix"), Kind::Log);
        assert_eq!(
            kind("# source: bench\ntime_s,p_ch_bar_gauge\n0,1\n"),
            Kind::Log
        );
        assert_eq!(kind("Zeit [s];Druck [bar]\n0;1\n"), Kind::Log);
        assert_eq!(kind("0.0;1.5\n0.1;1.6\n"), Kind::Log);
        assert_eq!(
            kind("# a plant\n[coil]\nresistance_20c_ohm = 82\n"),
            Kind::Plant
        );
        assert_eq!(kind("schema = 1\n[time]\ncolumn = 1\n"), Kind::Mapping);
        assert_eq!(
            kind("schema = 1\nsignal.p_ch = { column = 1, unit = \"bar_gauge\" }\n"),
            Kind::Mapping
        );
        assert_eq!(kind(""), Kind::Unknown);
        assert_eq!(kind("\0\0\0"), Kind::Unknown);
    }

    #[test]
    fn a_corrected_command_has_each_file_at_its_option() {
        let kind_of = |path: &Path| match path.extension().and_then(|end| end.to_str()) {
            Some("csv") => Kind::Log,
            Some("toml") => Kind::Plant,
            _ => Kind::Unknown,
        };
        let check = |given: &str, wrong: &str, expected: &str| {
            let given = given.split(' ').map(str::to_owned).collect();
            assert_eq!(corrected(given, Path::new(wrong), &kind_of), expected);
        };
        check(
            "compare --plant a.csv --log p.toml --json",
            "a.csv",
            "retarder compare --json --log a.csv --plant p.toml",
        );
        check(
            "compare p.toml",
            "p.toml",
            "retarder compare --plant p.toml --log LOG",
        );
        check(
            "diagnose p.toml a.csv",
            "p.toml",
            "retarder diagnose a.csv --plant p.toml",
        );
        check(
            "compare --plant=a.csv",
            "a.csv",
            "retarder compare --log a.csv",
        );
        // It takes one log, and has it.
        check(
            "compare --plant a.csv --log b.csv",
            "a.csv",
            "retarder compare --plant PLANT --log b.csv",
        );
        check(
            "compare b.csv --plant a.csv",
            "a.csv",
            "retarder compare b.csv --plant PLANT",
        );
        // These commands have no option `--log`.
        check(
            "control --plant a.csv --rigs 20",
            "a.csv",
            "retarder control --plant PLANT --rigs 20",
        );
        check("inspect p.toml", "p.toml", "retarder inspect LOG");
        check(
            "refine --log a.csv --check p.toml --out q.toml",
            "p.toml",
            "retarder refine --log a.csv --out q.toml --plant p.toml",
        );
    }
}
