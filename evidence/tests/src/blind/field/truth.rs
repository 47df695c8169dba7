//! Errors of the simulator with the true parameters and fitted clocks of the loggers: `retarder refine --fix all`.
//!
//! Reads the answers, after every rig was refined.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use thiserror::Error;

use super::super::format::Folders;
use super::super::run::{RunError, on_rig, output};
use super::super::score::{ScoreError, answers};
use super::format::FieldAnswer;
use super::ordinary::true_file;
use super::run::Retarder;

/// Reason why the errors of the true parameters are unknown.
#[derive(Debug, Error)]
pub enum TruthError {
    /// The answers could not be read.
    #[error(transparent)]
    Answers(#[from] ScoreError),
    /// A file could not be written, or the command did not start.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The command failed on a rig.
    #[error("{rig} with its true parameters: {said}")]
    Judge {
        /// Rig.
        rig: String,
        /// Output of the command.
        said: String,
    },
}

/// Computes the errors of the true parameters of every rig of `folders` without a result, `jobs` at a time. `progress`
/// gets the number of finished rigs, and of all.
///
/// # Errors
/// Returns an error if answers cannot be read, or the command fails on one of them.
pub fn run(
    folders: &Folders,
    retarder: &Retarder,
    jobs: usize,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<(), TruthError> {
    let answers: Vec<FieldAnswer> = answers(folders)?;
    let truth = folders.truth();
    fs::create_dir_all(&truth).map_err(|error| RunError::File(truth, error))?;
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || -> Result<(), TruthError> {
        while let Some(answer) = answers.get(next.fetch_add(1, Ordering::Relaxed)) {
            if !folders.judged_truth(&answer.rig).exists() {
                judge(folders, retarder, answer)?;
            }
            progress(1 + done.fetch_add(1, Ordering::Relaxed), answers.len());
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs.max(1)).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().expect("a worker does not panic"))
    })
}

fn judge(
    folders: &Folders,
    Retarder { retarder }: &Retarder,
    answer: &FieldAnswer,
) -> Result<(), TruthError> {
    let rig = &answer.rig;
    let judged = folders.judged_truth(rig);
    let plant = judged.with_extension("true.toml");
    let text = true_file(answer.is_vent_normally_open, &answer.parameters);
    fs::write(&plant, text).map_err(|error| RunError::File(plant.clone(), error))?;
    let mut refine = on_rig(retarder, &plant, "refine", folders, rig);
    refine
        .args(["--fix", "all", "--out"])
        .arg(judged.with_extension("toml"))
        .arg("--json")
        .arg(&judged);
    let output = output(retarder, &mut refine)?;
    if output.status.success() {
        return Ok(());
    }
    Err(TruthError::Judge {
        rig: rig.clone(),
        said: String::from_utf8_lossy(&output.stderr).into_owned(),
    })
}
