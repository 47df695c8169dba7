//! Runs of the closed loop, and batches of them.

use hil_harness::rigs::RigVerdict;
use hil_harness::{Run, Verdict};

use crate::closed_loop::ClosedLoop;
use crate::named_plant::NamedPlant;
use crate::project::Project;

/// Loop on every plant of the project, with its settings.
pub(crate) struct Controlled {
    pub(crate) request: ClosedLoop,
    pub(crate) runs: Vec<Judged>,
}

/// Run and its verdict.
pub(crate) struct Judged {
    pub(crate) plant: NamedPlant,
    pub(crate) run: Run,
    pub(crate) verdict: Verdict,
}

impl Controlled {
    /// Returns whether a run now would have the same result.
    pub(crate) fn is_of(&self, project: &Project) -> bool {
        let plants = NamedPlant::all_of(project).unwrap_or_default();
        // The size of a batch does not affect a run.
        let request = ClosedLoop {
            rigs: self.request.rigs,
            ..project.closed_loop.clone()
        };
        request == self.request && plants.iter().eq(self.runs.iter().map(|run| &run.plant))
    }
}

/// Verdicts of a batch, for each plant.
pub(crate) struct Batch {
    pub(crate) request: ClosedLoop,
    pub(crate) plants: Vec<(NamedPlant, Vec<RigVerdict>)>,
}

impl Batch {
    /// Returns the verdicts of the rigs about a plant.
    pub(crate) fn rigs_of(&self, plant: &NamedPlant) -> Option<&[RigVerdict]> {
        let (_, rigs) = self.plants.iter().find(|(mine, _)| mine == plant)?;
        Some(rigs)
    }

    /// Returns whether a batch now would have the same result.
    pub(crate) fn is_of(&self, project: &Project) -> bool {
        let plants = NamedPlant::all_of(project).unwrap_or_default();
        let mine = self.plants.iter().map(|(plant, _)| plant);
        project.closed_loop == self.request && plants.iter().eq(mine)
    }
}
