//! Result of a diagnosis.

use std::sync::Arc;

use model_lab::diagnosis::Diagnosis;
use model_lab::diagnosis::next_experiment::{DeterminingExperiment, NextExperiment};
use serde::{Deserialize, Serialize};

use crate::plant_file::PlantFile;
use crate::project::Project;
use crate::refusal::Refusal;

/// Diagnosis with its inputs.
#[derive(Serialize, Deserialize)]
pub(crate) struct Diagnosed {
    pub(crate) diagnosis: Diagnosis,
    pub(crate) plant: PlantFile,
    pub(crate) chosen: Chosen,
}

impl Diagnosed {
    /// Returns whether this diagnosis explains the error of the project's plant: nothing material remains, and the plant
    /// is the diagnosed one, or has each named effect with values in the fitted intervals.
    pub(crate) fn explains(&self, project: &Project) -> bool {
        let diagnosis = &self.diagnosis;
        let history = &project.history;
        let is_ancestor = || {
            let mut steps = history.steps().iter();
            history.is_of(&project.plant) && steps.any(|step| step.plant == self.plant)
        };
        let has = |id: &String| {
            let mut effects = history.now().effects.iter();
            effects.any(|effect| effect.effect == *id && effect.is_as_fitted())
        };
        diagnosis.explains()
            && (self.plant == project.plant || is_ancestor() && diagnosis.effects.iter().all(has))
    }
}

/// Experiment that determines parameters, with the plant that it was planned for.
#[derive(Serialize, Deserialize)]
pub(crate) struct Determining {
    pub(crate) next: DeterminingExperiment,
    pub(crate) plant: PlantFile,
}

/// Results that take a minute and little memory: they are stored with their project.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(crate) struct Findings {
    pub(crate) diagnosed: Option<Arc<Diagnosed>>,
    /// Last experiment that was planned after the diagnosis.
    pub(crate) next: Option<Arc<NextExperiment>>,
    /// Last experiment that was planned after an estimation.
    #[serde(default)]
    pub(crate) determining: Option<Arc<Determining>>,
}

/// Numbers of the training logs and of the validation logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Chosen {
    pub(crate) logs: Vec<u32>,
    pub(crate) check: Vec<u32>,
}

impl Chosen {
    /// Refuses a choice that cannot be fitted.
    pub(crate) fn check(&self, project: &Project) -> Result<(), Refusal> {
        if self.logs.is_empty() {
            return Err(Refusal::value(
                "no training log is selected; select at least one",
            ));
        }
        for number in self.logs.iter().chain(&self.check) {
            project.log(*number)?;
        }
        match self.logs.iter().find(|log| self.check.contains(log)) {
            Some(number) => Err(Refusal::value(format!(
                "log {number} is selected for training and for validation; select one of the two"
            ))),
            None => Ok(()),
        }
    }
}
