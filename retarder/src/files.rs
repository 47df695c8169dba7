//! Files of a command: all are collected before any work, and no output may be an input.
//!
//! They come from the definition of the command line, so that none is forgotten: an option with a path has a
//! [`ValueHint`], and [`OUTPUTS`] names the options that write.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command, ValueHint};
use recording::FileIdentity;

use crate::failure::Failure;
use crate::input::is_built_in_controller;
use crate::targets::{Existing, is_standard_output};

/// Options that name a file to write; every other option with a file names one to read.
const OUTPUTS: [&str; 5] = ["out", "html", "json", "missing_flow", "rigs_out"];
/// Arguments without a name that name a file to read, and their names in messages.
const POSITIONAL: [(&str, &str); 3] = [("path", "LOG"), ("paths", "LOG"), ("shards", "FILE")];
/// Commands whose output may replace their input: command, input option and output option.
const REPLACES_ITS_INPUT: [(&str, &str, &str); 1] = [("refine", "plant", "out")];
/// File that the demo writes.
pub(crate) const DEMO_REPORT: &str = "report.html";
/// Path that stands for the standard input or output.
const STANDARD: &str = "-";

/// Files that a command reads and writes.
#[derive(Debug, Default)]
pub(crate) struct Files {
    command: String,
    inputs: Vec<Named>,
    outputs: Vec<Output>,
    existing: Existing,
}

#[derive(Debug, Clone)]
struct Named {
    /// Identifier of the option; empty if the file does not come from an option.
    option: String,
    /// Name of the file in messages.
    label: String,
    path: PathBuf,
    /// Identity of the file; `None` if it is not a file, such as a terminal.
    identity: Option<FileIdentity>,
}

#[derive(Debug)]
struct Output {
    file: Named,
    /// Whether the file is a default that the command line does not name.
    is_implied: bool,
}

impl Files {
    /// Collects the files that the arguments name or imply.
    pub(crate) fn of(command: &Command, matches: &ArgMatches, existing: Existing) -> Self {
        let mut files = Self {
            existing,
            ..Self::default()
        };
        if matches.subcommand().is_none() {
            files.outputs.push(Output {
                file: Named::demo_report(),
                is_implied: true,
            });
        }
        files.collect(command, matches);
        files
    }

    fn collect(&mut self, command: &Command, matches: &ArgMatches) {
        for argument in command.get_arguments().filter(|argument| is_file(argument)) {
            let id = argument.get_id().as_str();
            let values = matches.try_get_many::<PathBuf>(id).ok().flatten();
            for path in values.into_iter().flatten() {
                if OUTPUTS.contains(&id) {
                    self.outputs.push(Output {
                        file: Named::output(id, path),
                        is_implied: matches.value_source(id) == Some(ValueSource::DefaultValue),
                    });
                } else if !(id == "controller" && is_built_in_controller(path)) {
                    self.inputs.push(Named::input(id, path));
                }
            }
        }
        if let Some((name, matches)) = matches.subcommand()
            && let Some(command) = command.find_subcommand(name)
        {
            self.command = name.to_owned();
            self.collect(command, matches);
        }
    }

    /// Refuses outputs that would destroy an input or each other, may not be replaced, or cannot be written. Creates no
    /// file. Returns the notes to show before the work.
    pub(crate) fn check(&self) -> Result<Vec<String>, Failure> {
        let mut notes = Vec::new();
        let (standard, files): (Vec<_>, Vec<_>) = self
            .outputs
            .iter()
            .partition(|output| is_standard_output(&output.file.path));
        if let [first, _, ..] = standard[..] {
            return Err(Failure::TwoOnStandardOutput {
                option: first.file.label.clone(),
            });
        }
        let mut written = vec![Named::standard_output()];
        for output in files {
            notes.extend(self.check_against_inputs(&output.file)?);
            if let Some(other) = written.iter().find(|other| other.is_same(&output.file)) {
                return Err(Failure::OneFileForTwo {
                    path: output.file.path.clone(),
                    one: other.label.clone(),
                    other: output.file.label.clone(),
                });
            }
            written.push(output.file.clone());
            self.check_existing(output)?;
        }
        // Output redirected to an input is appended to it, or the shell has already emptied it.
        self.check_against_inputs(&written[0])?;
        Ok(notes)
    }

    fn check_against_inputs(&self, output: &Named) -> Result<Option<String>, Failure> {
        let mut note = None;
        for input in self.inputs.iter().filter(|input| input.is_same(output)) {
            let pair = (&*self.command, &*input.option, &*output.option);
            if !REPLACES_ITS_INPUT.contains(&pair) {
                return Err(Failure::OutputIsInput {
                    path: output.path.clone(),
                    output: output.label.clone(),
                    input: input.label.clone(),
                });
            }
            note = Some(format!(
                "{}: the file of {} will be replaced by the result, as {} says",
                output.path.display(),
                input.label.clone(),
                output.label.clone()
            ));
        }
        Ok(note)
    }

    fn check_existing(&self, output: &Output) -> Result<(), Failure> {
        let path = &output.file.path;
        if self.existing == Existing::Keep && path.exists() {
            return Err(Failure::Exists { path: path.clone() });
        }
        if output.is_implied && path.is_file() && !is_report(path) {
            return Err(Failure::NotOurReport {
                path: path.clone(),
                is_demo: self.command.is_empty(),
            });
        }
        // Created and dropped, so that no file remains.
        let begun = self.existing.begin(path);
        begun.map_err(|error| Failure::write(Some(path), error))?;
        Ok(())
    }
}

impl Named {
    fn new(option: &str, path: &Path, identity: Option<FileIdentity>) -> Self {
        Self {
            option: option.to_owned(),
            label: match POSITIONAL.iter().find(|(name, _)| *name == option) {
                Some((_, label)) => (*label).to_owned(),
                None => format!("--{}", option.replace('_', "-")),
            },
            path: path.to_path_buf(),
            identity,
        }
    }

    fn input(option: &str, path: &Path) -> Self {
        let identity = match path == Path::new(STANDARD) {
            true => redirected(Standard::Input),
            false => Some(FileIdentity::of(path)),
        };
        Self::new(option, path, identity)
    }

    fn output(option: &str, path: &Path) -> Self {
        let identity = (!is_standard_output(path)).then(|| FileIdentity::of(path));
        Self::new(option, path, identity)
    }

    fn demo_report() -> Self {
        Self {
            label: "the demo".to_owned(),
            ..Self::output("", Path::new(DEMO_REPORT))
        }
    }

    fn standard_output() -> Self {
        let label = "the standard output";
        Self {
            label: label.to_owned(),
            ..Self::new("", Path::new(label), redirected(Standard::Output))
        }
    }

    fn is_same(&self, other: &Self) -> bool {
        self.identity.is_some() && self.identity == other.identity
    }
}

#[derive(Debug, Clone, Copy)]
enum Standard {
    Input,
    Output,
}

/// Returns the file that a stream of the process is redirected from or to; `None` for pipes and terminals.
#[cfg(unix)]
fn redirected(stream: Standard) -> Option<FileIdentity> {
    use std::os::fd::AsFd as _;
    let descriptor = match stream {
        Standard::Input => io::stdin().as_fd().try_clone_to_owned(),
        Standard::Output => io::stdout().as_fd().try_clone_to_owned(),
    };
    FileIdentity::of_open(&File::from(descriptor.ok()?))
}

#[cfg(not(unix))]
fn redirected(_: Standard) -> Option<FileIdentity> {
    None
}

fn is_file(argument: &Arg) -> bool {
    argument.get_value_hint() == ValueHint::FilePath
}

/// Number of bytes in which a report names its generator.
const BEGINNING_BYTES: u64 = 4096;

fn is_report(path: &Path) -> bool {
    let mut beginning = Vec::new();
    let read = |file: File| file.take(BEGINNING_BYTES).read_to_end(&mut beginning);
    File::open(path).and_then(read).is_ok() && report::is_report(&beginning)
}

#[cfg(test)]
mod tests {
    use std::any::TypeId;

    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::Cli;

    /// Options that name a file to read.
    const INPUTS: [&str; 12] = [
        "path",
        "paths",
        "log",
        "check",
        "mapping",
        "plant",
        "from_datasheet",
        "controller",
        "requirements",
        "reference",
        "image",
        "shards",
    ];

    fn check(command: &Command) {
        for argument in command.get_arguments() {
            let id = argument.get_id().as_str();
            if argument.get_value_parser().type_id() == TypeId::of::<PathBuf>() {
                let hint = argument.get_value_hint();
                assert!(
                    [ValueHint::FilePath, ValueHint::DirPath].contains(&hint),
                    "{}: --{id} has no hint that it is a file",
                    command.get_name()
                );
            }
            // `settings --requirements` prints a file and takes none.
            let takes_file = argument.get_action().takes_values();
            assert_eq!(
                is_file(argument),
                takes_file && (INPUTS.contains(&id) || OUTPUTS.contains(&id)),
                "{}: --{id}: read or written?",
                command.get_name()
            );
        }
        command.get_subcommands().for_each(check);
    }

    #[test]
    fn every_option_with_a_file_is_known_as_read_or_written() {
        check(&Cli::command());
    }
}
