//! Runs the released command on every rig: plant file from its plate, then the diagnosis; reads no answer.

use std::fs;
use std::process::{Command, Stdio};

use super::super::field::run::{Progress, Retarder};
use super::super::format::Folders;
use super::super::run::{RunError, on_rig, output, rigs, run_each};

/// Diagnoses every rig of `folders` that has no finding yet, one after the other, from its plate. A rig that leaves no
/// finding leaves a file with the output of the command. Returns the number of those.
///
/// # Errors
/// Returns an error if files cannot be read or written, or the command does not start.
pub fn diagnose(
    folders: &Folders,
    Retarder { retarder }: &Retarder,
    progress: impl Fn(Progress) + Sync,
) -> Result<usize, RunError> {
    let stage = folders.found();
    run_each(&stage, &rigs(folders)?, 1, progress, |rig| {
        let mut parameters = Command::new(retarder);
        parameters
            .args(["parameters", "--from-datasheet"])
            .arg(folders.plate(rig))
            .stdin(Stdio::null());
        let written = output(retarder, &mut parameters)?;
        if !written.status.success() {
            return Ok(written);
        }
        let plant = stage.plant(rig);
        fs::write(&plant, &written.stdout).map_err(|error| RunError::File(plant.clone(), error))?;
        let mut diagnose = on_rig(retarder, &plant, "diagnose", folders, rig);
        output(retarder, diagnose.arg("--json").arg(stage.finding(rig)))
    })
}
