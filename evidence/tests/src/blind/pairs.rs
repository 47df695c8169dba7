//! Detectability of each of two hidden effects beside the other one: a model is fitted with one of them, and its error
//! shows the other.
//!
//! Reads the answers, after the diagnosis has ended.

use std::fs;
use std::path::Path;

use thiserror::Error;

use super::format::{Answer, Class, Folders};
use super::run::{Released, RunError};
use super::score::{ScoreError, answers};

/// Reason why the detectable pairs are unknown.
#[derive(Debug, Error)]
pub enum PairsError {
    /// The answers could not be read.
    #[error(transparent)]
    Answers(#[from] ScoreError),
    /// A folder could not be created, or the command did not start.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The command could not fit an effect.
    #[error("{rig} with {effect} alone: {said}")]
    Refine {
        /// Rig.
        rig: String,
        /// Fitted effect.
        effect: String,
        /// Output of the command.
        said: String,
    },
}

/// Fits every pair of `folders` with each of its effects alone, unless there is a result. `progress` gets the number of
/// finished fits, and of all.
///
/// # Errors
/// Returns an error if answers cannot be read, or the command cannot fit one of them.
pub fn run(
    folders: &Folders,
    command: &Released,
    progress: impl Fn(usize, usize),
) -> Result<(), PairsError> {
    let alone = folders.alone();
    fs::create_dir_all(&alone).map_err(|error| RunError::File(alone, error))?;
    let pairs: Vec<Answer> = answers(folders)?;
    let pairs = pairs.iter().filter(|answer| answer.class == Class::Two);
    let effects: Vec<(&Answer, &str)> = pairs
        .flat_map(|answer| {
            let hidden = answer.hidden.iter();
            hidden.map(move |hidden| (answer, hidden.effect.as_str()))
        })
        .collect();
    for (done, (answer, effect)) in effects.iter().enumerate() {
        let left = folders.alone_with(&answer.rig, effect);
        if !left.exists() {
            refine(folders, command, (&answer.rig, effect), &left)?;
        }
        progress(done + 1, effects.len());
    }
    Ok(())
}

fn refine(
    folders: &Folders,
    command: &Released,
    (rig, effect): (&str, &str),
    left: &Path,
) -> Result<(), PairsError> {
    let mut fit = command.on("refine", folders, rig);
    fit.args(["--add", effect, "--out"])
        .arg(left.with_extension("toml"))
        .arg("--json")
        .arg(left);
    let output = command.output(&mut fit)?;
    if output.status.success() {
        return Ok(());
    }
    Err(PairsError::Refine {
        rig: rig.to_owned(),
        effect: effect.to_owned(),
        said: String::from_utf8_lossy(&output.stderr).into_owned(),
    })
}
