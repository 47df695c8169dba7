//! Planning of the experiment that distinguishes rival effects, or determines parameters.

use model_lab::diagnosis::next_experiment::{
    DeterminingExperiment, Limits, NextExperiment, Question, determining_experiment,
    next_experiment,
};
use recording::Recording;

use super::Answer;
use super::diagnose::watched;
use crate::failure::Failure;
use crate::input::NamedPlant;

/// Question to be answered by the experiment.
pub(crate) struct Task {
    pub(crate) plant: NamedPlant,
    pub(crate) log: Recording,
    /// Ids of the effects: several to distinguish, or one to detect. Empty if parameters are to be determined.
    pub(crate) effects: Vec<String>,
    /// Parameters to be determined.
    pub(crate) determine: Vec<String>,
    pub(crate) limits: Limits,
}

/// Experiment that determines parameters, with its plant.
pub(crate) struct Determining {
    pub(crate) plant: NamedPlant,
    pub(crate) next: DeterminingExperiment,
}

/// Simulates the test signals and ranks them by the parameters that they determine.
pub(crate) fn determine(task: Task) -> Result<Determining, Failure> {
    let what: Vec<&str> = task.determine.iter().map(String::as_str).collect();
    let plant = &task.plant.parameters;
    let next =
        watched(|watch| determining_experiment(plant, &[task.log], &what, task.limits, watch))?;
    Ok(Determining {
        plant: task.plant,
        next,
    })
}

impl Determining {
    pub(crate) fn answer(&self) -> Answer {
        Answer::of(self.next.determines_all())
    }
}

/// Experiment that distinguishes effects, with its plant.
pub(crate) struct Planned {
    pub(crate) plant: NamedPlant,
    pub(crate) next: NextExperiment,
}

/// Fits the effects, and ranks the test signals by how well they distinguish them.
pub(crate) fn run(task: Task) -> Result<Planned, Failure> {
    let ids: Vec<&str> = task.effects.iter().map(String::as_str).collect();
    let question = match ids[..] {
        [id] => Question::For(id),
        _ => Question::Between(&ids),
    };
    let next = watched(|watch| {
        next_experiment(
            &task.plant.parameters,
            &[task.log],
            question,
            task.limits,
            watch,
        )
    })?;
    Ok(Planned {
        plant: task.plant,
        next,
    })
}

impl Planned {
    pub(crate) fn answer(&self) -> Answer {
        Answer::of(self.next.distinguishes())
    }
}
