//! Runs of the binary in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// Temporary folder to run the binary in.
pub(crate) struct Bench(TempDir);

/// Result of a run.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) status: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Writes a file with this text, and creates its folders.
    pub(crate) fn file(&self, name: &str, text: &str) -> &Self {
        fs::write(self.path(name), text).unwrap();
        self
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Returns the names of all files.
    pub(crate) fn files(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// Creates the command: no terminal, no colours, 100 columns.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_retarder"));
        command
            .args(arguments)
            .current_dir(self.0.path())
            .env("COLUMNS", "100")
            .env_remove("CLICOLOR_FORCE")
            .env_remove("NO_COLOR");
        command
    }

    /// Runs the command with the file `name` as its standard input.
    pub(crate) fn run_reading(&self, arguments: &[&str], name: &str) -> Ran {
        let input = fs::File::open(self.path(name)).unwrap();
        Ran::of(self.command(arguments).stdin(input).output().unwrap())
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Ran {
        Ran::of(self.command(arguments).output().unwrap())
    }
}

impl Ran {
    pub(crate) fn of(output: Output) -> Self {
        Self {
            status: output.status.code().expect("not ended by a signal"),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Asserts that the run ended with `status`; returns the standard output.
    #[track_caller]
    pub(crate) fn ended_with(self, status: i32) -> String {
        assert_eq!(self.status, status, "{}\n{}", self.out, self.err);
        self.out
    }
}

/// Reads a bundled file.
pub(crate) fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../data")
        .join(name);
    path.to_str().unwrap().to_owned()
}

/// Returns the first seconds of a bundled log.
pub(crate) fn beginning_of(name: &str, seconds: f64) -> String {
    let text = fs::read_to_string(data(name)).unwrap();
    let is_early = |line: &&str| {
        let time_s: Option<f64> = line.split(',').next().and_then(|time| time.parse().ok());
        time_s.is_none_or(|time_s| time_s < seconds)
    };
    text.lines()
        .take_while(is_early)
        .map(|line| format!("{line}\n"))
        .collect()
}

/// Returns a log of one second: shut, filling from 0.2 s, shut from 0.4 s.
pub(crate) fn short_log() -> String {
    (0..100).fold(
        "time_s,duty_fill_pct,duty_vent_pct\n".to_owned(),
        |text, row| {
            let duty = if (20..40).contains(&row) { 60 } else { 0 };
            text + &format!("{:.2},{duty},0\n", f64::from(row) * 0.01)
        },
    )
}

#[track_caller]
pub(crate) fn assert_contains(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
}
