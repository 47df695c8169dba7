//! Does each of two hidden effects show beside the other one? A model that is told one of them, and fitted, leaves the other.
//!
//! It opens the answers, after the diagnosis has given its own.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use thiserror::Error;

use super::format::{Answer, Class, Folders};
use super::run::Diagnose;
use super::score::{ScoreError, answers};

/// Why it is not known which pairs show.
#[derive(Debug, Error)]
pub enum PairsError {
    /// The answers could not be read.
    #[error(transparent)]
    Answers(#[from] ScoreError),
    /// A folder could not be made.
    #[error("{}: {}", .0.display(), .1)]
    File(PathBuf, #[source] io::Error),
    /// The command did not start.
    #[error("{} does not start: {}; build it, or say where it is", .0.display(), .1)]
    Start(PathBuf, #[source] io::Error),
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
    command: &Diagnose,
    progress: impl Fn(usize, usize),
) -> Result<(), PairsError> {
    let alone = folders.alone();
    fs::create_dir_all(&alone).map_err(|error| PairsError::File(alone, error))?;
    let pairs = answers(folders)?;
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
    command: &Diagnose,
    (rig, effect): (&str, &str),
    left: &Path,
) -> Result<(), PairsError> {
    let output = Command::new(&command.retarder)
        .args(["refine", "--add", effect, "--plant"])
        .arg(&command.plant)
        .arg("--log")
        .arg(folders.id_log(rig))
        .arg("--check")
        .arg(folders.check_log(rig))
        .arg("--out")
        .arg(left.with_extension("toml"))
        .arg("--json")
        .arg(left)
        .stdin(Stdio::null())
        .output()
        .map_err(|error| PairsError::Start(command.retarder.clone(), error))?;
    if output.status.success() {
        return Ok(());
    }
    Err(PairsError::Refine {
        rig: rig.to_owned(),
        effect: effect.to_owned(),
        said: String::from_utf8_lossy(&output.stderr).into_owned(),
    })
}
