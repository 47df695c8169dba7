//! Does each of two hidden effects show beside the other one? A model that is told one of them, and fitted, leaves the other.
//!
//! It opens the answers, after the diagnosis has given its own.

use std::fs;
use std::path::Path;

use thiserror::Error;

use super::format::{Answer, Class, Folders};
use super::run::{Released, RunError};
use super::score::{ScoreError, answers};

/// Why it is not known which pairs show.
#[derive(Debug, Error)]
pub enum PairsError {
    /// The answers could not be read.
    #[error(transparent)]
    Answers(#[from] ScoreError),
    /// A folder could not be made, or the command did not start.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The command could not fit an effect.
    #[error("{rig} with {effect} alone: {said}")]
    Refine {
        /// The rig.
        rig: String,
        /// The effect that was told.
        effect: String,
        /// What the command said.
        said: String,
    },
}

/// Fits every pair of `folders` with each of its effects alone, unless that is done already. `progress` is told how many
/// of all fits are done.
///
/// # Errors
/// If answers cannot be read, or the command cannot fit one of them.
pub fn run(
    folders: &Folders,
    command: &Released,
    progress: impl Fn(usize, usize),
) -> Result<(), PairsError> {
    let alone = folders.alone();
    fs::create_dir_all(&alone).map_err(|error| RunError::File(alone, error))?;
    let pairs: Vec<Answer> = answers(folders)?;
    let pairs = pairs.iter().filter(|answer| answer.class == Class::Two);
    let told: Vec<(&Answer, &str)> = pairs
        .flat_map(|answer| {
            let hidden = answer.hidden.iter();
            hidden.map(move |hidden| (answer, hidden.effect.as_str()))
        })
        .collect();
    for (done, (answer, effect)) in told.iter().enumerate() {
        let left = folders.alone_with(&answer.rig, effect);
        if !left.exists() {
            refine(folders, command, (&answer.rig, effect), &left)?;
        }
        progress(done + 1, told.len());
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
