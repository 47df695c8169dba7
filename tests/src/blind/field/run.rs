//! Lets the released command refine the first plant file of every field rig; opens no answer.

use std::path::PathBuf;

use super::super::format::Folders;
pub use super::super::run::Progress;
use super::super::run::{RunError, on_rig, output, run_each};

/// The released command.
#[derive(Debug, Clone, clap::Args)]
pub struct Retarder {
    /// The command `retarder`.
    #[arg(long)]
    pub retarder: PathBuf,
}

/// Refines the first plant file of every rig of `folders` that has no finding yet, `jobs` at a time. A rig whose refinement fails
/// leaves a file with what it said instead of a finding; the next run tries it again. Gives the number of those.
///
/// # Errors
/// If files cannot be read or written, or the command does not start.
pub fn run(
    folders: &Folders,
    Retarder { retarder }: &Retarder,
    jobs: usize,
    progress: impl Fn(Progress) + Sync,
) -> Result<usize, RunError> {
    run_each(folders, jobs, progress, |rig| {
        let mut refine = on_rig(retarder, &folders.plant(rig), "refine", folders, rig);
        refine.arg("--out").arg(folders.refined(rig));
        output(retarder, refine.arg("--json").arg(folders.finding(rig)))
    })
}
