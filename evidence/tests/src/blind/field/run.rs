//! Runs the released command on every field rig: refines its first plant file, then diagnoses its refined plant; reads
//! no answer.

use std::path::PathBuf;

use super::super::format::Folders;
pub use super::super::run::Progress;
use super::super::run::{RunError, on_rig, output, rigs, run_each};
use super::super::score::finding::Finding;
use super::super::score::found;

/// Released command.
#[derive(Debug, Clone, clap::Args)]
pub struct Retarder {
    /// Path of the command `retarder`.
    #[arg(long)]
    pub retarder: PathBuf,
}

/// Refines the first plant file of every rig of `folders` that has no finding yet, `jobs` at a time. A rig whose
/// refinement fails leaves a file with the command's output instead of a finding; the next run tries it again. Returns
/// the number of those.
///
/// # Errors
/// Returns an error if files cannot be read or written, or the command does not start.
pub fn refine(
    folders: &Folders,
    Retarder { retarder }: &Retarder,
    jobs: usize,
    progress: impl Fn(Progress) + Sync,
) -> Result<usize, RunError> {
    let stage = folders.found();
    run_each(&stage, &rigs(folders)?, jobs, progress, |rig| {
        let mut refine = on_rig(retarder, &folders.plant(rig), "refine", folders, rig);
        refine.arg("--out").arg(stage.plant(rig));
        output(retarder, refine.arg("--json").arg(stage.finding(rig)))
    })
}

/// Diagnoses every rig of `folders` with its refined plant, like [`refine`].
///
/// # Errors
/// Returns an error if files cannot be read or written, or the command does not start.
pub fn diagnose(
    folders: &Folders,
    Retarder { retarder }: &Retarder,
    jobs: usize,
    progress: impl Fn(Progress) + Sync,
) -> Result<usize, RunError> {
    let (refined, stage) = (folders.found(), folders.named());
    run_each(&stage, &rigs(folders)?, jobs, progress, |rig| {
        let mut diagnose = on_rig(retarder, &refined.plant(rig), "diagnose", folders, rig);
        output(retarder, diagnose.arg("--json").arg(stage.finding(rig)))
    })
}

/// Adds the named effects to the refined plant of every rig of `folders` that has any, like [`refine`].
///
/// # Errors
/// Returns an error if files cannot be read or written, or the command does not start.
pub fn fit(
    folders: &Folders,
    Retarder { retarder }: &Retarder,
    jobs: usize,
    progress: impl Fn(Progress) + Sync,
) -> Result<usize, RunError> {
    let (refined, stage) = (folders.found(), folders.fitted());
    let mut named = Vec::new();
    for rig in rigs(folders)? {
        if !forms(folders, &rig)?.is_empty() {
            named.push(rig);
        }
    }
    run_each(&stage, &named, jobs, progress, |rig| {
        let mut fit = on_rig(retarder, &refined.plant(rig), "refine", folders, rig);
        for form in forms(folders, rig)? {
            fit.arg("--add").arg(form);
        }
        fit.arg("--out").arg(stage.plant(rig));
        output(retarder, fit.arg("--json").arg(stage.finding(rig)))
    })
}

/// Returns the named effects of a rig with the forms of their laws; empty if the diagnosis did not end.
fn forms(folders: &Folders, rig: &str) -> Result<Vec<String>, RunError> {
    let finding: Option<Finding> = found(&folders.named().finding(rig))?;
    Ok(finding.map(|finding| finding.forms()).unwrap_or_default())
}
