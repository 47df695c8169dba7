//! Results of other pages about the plant.

use model_lab::diagnosis::Diagnosis;
use plant_sim::PlantParameters;
use recording::Recording;
use report::{BeforeAndAfter, DiagnosisPart, HistoryPart, HistoryStep};

use crate::history::History;
use crate::plant_file::PlantFile;
use crate::project::Project;
use crate::session::Session;

/// The last diagnosis and the history of the plant; empty if there is none.
#[derive(Default)]
pub(super) struct Findings {
    /// Diagnosis, and the diagnosed plant.
    pub(super) diagnosis: Option<(Diagnosis, PlantParameters)>,
    /// Steps of the refinement.
    pub(super) steps: Vec<HistoryStep>,
    /// Whether the diagnosis explains the error of the plant.
    pub(super) is_explained: bool,
    /// Current step.
    current: usize,
}

impl Findings {
    /// Returns the results of `session` for its plant; history and diagnosis of a plant that was open before are left
    /// out.
    pub(super) fn of(session: &Session) -> Self {
        let project = session.project();
        let diagnosed = session.findings().diagnosed;
        let is_explained = diagnosed
            .as_ref()
            .is_some_and(|diagnosed| diagnosed.explains(&project));
        let Project { history, plant, .. } = project;
        let history = if history.is_of(&plant) {
            history
        } else {
            History::default()
        };
        let is_of_plant = |diagnosed: &PlantFile| {
            let mut steps = history.steps().iter();
            *diagnosed == plant || steps.any(|step| step.plant == *diagnosed)
        };
        let steps = history.steps().iter().map(|step| HistoryStep {
            what: step.done.clone(),
            log: step.log.clone(),
            errors: step
                .errors
                .iter()
                .filter_map(|error| Some((error.signal.clone(), error.rms?, error.noise_floor)))
                .collect(),
        });
        Self {
            is_explained,
            diagnosis: diagnosed.and_then(|diagnosed| {
                if !is_of_plant(&diagnosed.plant) {
                    return None;
                }
                let plant = diagnosed.plant.parameters().ok()?;
                Some((diagnosed.diagnosis.clone(), plant))
            }),
            steps: steps.collect(),
            current: history.at(),
        }
    }

    /// Returns the log of `logs` with the largest error, before and after the named effects.
    pub(super) fn before_and_after<'a>(
        &self,
        logs: &[&'a Recording],
    ) -> Option<BeforeAndAfter<'a>> {
        let (diagnosis, plant) = self.diagnosis.as_ref()?;
        BeforeAndAfter::worst(diagnosis, plant, logs)
    }

    pub(super) fn diagnosis_part<'a>(
        &'a self,
        runs: Option<&'a BeforeAndAfter<'a>>,
    ) -> Option<DiagnosisPart<'a>> {
        let (diagnosis, _) = self.diagnosis.as_ref()?;
        Some(DiagnosisPart {
            diagnosis,
            runs,
            next_command: None,
        })
    }

    pub(super) fn history_part(&self) -> Option<HistoryPart<'_>> {
        (!self.steps.is_empty()).then_some(HistoryPart {
            steps: &self.steps,
            current: self.current,
        })
    }
}
