//! Runs the diagnosis of the released command on the logs of a draw, rig by rig; reads no answer.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use thiserror::Error;

use super::format::{Folders, Stage};
use super::score::ScoreError;

/// Reason why a run cannot continue.
#[derive(Debug, Error)]
pub enum RunError {
    /// A file or a folder could not be read or written.
    #[error("{}: {}", .0.display(), .1)]
    File(PathBuf, #[source] io::Error),
    /// There is nothing to diagnose.
    #[error("no log called `*-id.csv` in {}; draw first", .0.display())]
    NoLogs(PathBuf),
    /// The command did not start.
    #[error("{} does not start: {}; build it, or say where it is", .0.display(), .1)]
    Start(PathBuf, #[source] io::Error),
    /// A finding of an earlier stage could not be read.
    #[error(transparent)]
    Finding(#[from] ScoreError),
}

/// Released command with its plant.
#[derive(Debug, Clone, clap::Args)]
pub struct Released {
    /// Path of the command `retarder`.
    #[arg(long)]
    pub retarder: PathBuf,
    /// Plant of the datasheet.
    #[arg(long, default_value = "data/nominal-plant.toml")]
    pub plant: PathBuf,
}

impl Released {
    /// Creates a subcommand with the logs of a rig and an empty standard input.
    pub(super) fn on(&self, subcommand: &str, folders: &Folders, rig: &str) -> Command {
        on_rig(&self.retarder, &self.plant, subcommand, folders, rig)
    }

    /// Returns the output of `command` and its exit status.
    pub(super) fn output(&self, command: &mut Command) -> Result<Output, RunError> {
        output(&self.retarder, command)
    }
}

/// Creates a subcommand of `retarder` with a plant, the logs of a rig and an empty standard input.
pub(super) fn on_rig(
    retarder: &Path,
    plant: &Path,
    subcommand: &str,
    folders: &Folders,
    rig: &str,
) -> Command {
    let mut command = Command::new(retarder);
    command
        .args([subcommand, "--plant"])
        .arg(plant)
        .arg("--log")
        .arg(folders.id_log(rig))
        .arg("--check")
        .arg(folders.check_log(rig))
        .stdin(Stdio::null());
    command
}

/// Returns the output of a command of `retarder`, and its exit status.
pub(super) fn output(retarder: &Path, command: &mut Command) -> Result<Output, RunError> {
    let started = command.output();
    started.map_err(|error| RunError::Start(retarder.to_owned(), error))
}

/// Progress of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Diagnosed rigs, including those of earlier runs.
    pub done: usize,
    /// All rigs.
    pub all: usize,
    /// Remaining time at the pace so far.
    pub left: Duration,
}

/// Diagnoses every rig of `folders` that has no finding yet, `jobs` at a time. A rig whose diagnosis fails leaves a
/// file with the command's output instead of a finding; the next run tries it again. Returns the number of those.
///
/// # Errors
/// Returns an error if files cannot be read or written, or the command does not start.
pub fn run(
    folders: &Folders,
    command: &Released,
    jobs: usize,
    progress: impl Fn(Progress) + Sync,
) -> Result<usize, RunError> {
    let stage = folders.found();
    run_each(&stage, &rigs(folders)?, jobs, progress, |rig| {
        command.output(
            command
                .on("diagnose", folders, rig)
                .arg("--json")
                .arg(stage.finding(rig)),
        )
    })
}

/// Runs `find` for each of `rigs` that has no finding in `stage`, `jobs` at a time. A rig without a finding leaves a
/// file with the command's output; the next run tries it again. Returns the number of those.
///
/// # Errors
/// Returns an error if files cannot be read or written, or the command does not start.
pub(super) fn run_each(
    stage: &Stage,
    rigs: &[String],
    jobs: usize,
    progress: impl Fn(Progress) + Sync,
    find: impl Fn(&str) -> Result<Output, RunError> + Sync,
) -> Result<usize, RunError> {
    let file = |path: &Path| {
        let path = path.to_owned();
        move |error| RunError::File(path, error)
    };
    fs::create_dir_all(stage.path()).map_err(file(stage.path()))?;
    let times = stage.times();
    let mut log = fs::OpenOptions::new();
    let log = log.create(true).append(true).open(&times);
    let log = Mutex::new(log.map_err(file(&times))?);
    let missing: Vec<_> = rigs
        .iter()
        .filter(|rig| !stage.finding(rig).exists())
        .collect();
    let (next, done, start) = (AtomicUsize::new(0), AtomicUsize::new(0), Instant::now());
    let work = || -> Result<(), RunError> {
        while let Some(rig) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
            let began = Instant::now();
            let output = find(rig)?;
            let seconds = began.elapsed().as_secs_f64();
            let code = keep(stage, rig, &output)?;
            let line = format!("{rig},{seconds:.2},{code}\n");
            let mut log = log.lock().expect("no thread panics while it writes");
            log.write_all(line.as_bytes()).map_err(file(&times))?;
            let now = 1 + done.fetch_add(1, Ordering::Relaxed);
            let rest = missing.len().saturating_sub(now);
            progress(Progress {
                done: rigs.len() - rest,
                all: rigs.len(),
                left: start.elapsed().mul_f64(rest as f64 / now as f64),
            });
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs.max(1)).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().expect("a worker does not panic"))
    })?;
    Ok(rigs
        .iter()
        .filter(|rig| !stage.finding(rig).exists())
        .count())
}

/// Returns the names of the rigs that have logs, in order.
pub(super) fn rigs(folders: &Folders) -> Result<Vec<String>, RunError> {
    let logs = folders.logs();
    let read = fs::read_dir(&logs).map_err(|error| RunError::File(logs.clone(), error))?;
    let mut rigs: Vec<String> = read
        .filter_map(|entry| {
            let name = entry.ok()?.file_name().into_string().ok()?;
            name.strip_suffix("-id.csv").map(str::to_owned)
        })
        .collect();
    rigs.sort();
    if rigs.is_empty() {
        return Err(RunError::NoLogs(logs));
    }
    Ok(rigs)
}

/// Stores the command's output if there is no finding; returns the exit code of the command, -1 if it was killed.
fn keep(stage: &Stage, rig: &str, output: &Output) -> Result<i32, RunError> {
    let said = stage.failed(rig);
    if stage.finding(rig).exists() {
        // File of an earlier run; usually missing.
        _ = fs::remove_file(&said);
    } else {
        let text = [&output.stdout[..], &output.stderr].concat();
        fs::write(&said, text).map_err(|error| RunError::File(said, error))?;
    }
    Ok(output.status.code().unwrap_or(-1))
}
