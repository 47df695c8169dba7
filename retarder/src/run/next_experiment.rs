//! Which experiment tells rival effects apart?

use model_lab::diagnosis::next_experiment::{Limits, NextExperiment, Question, next_experiment};
use recording::Recording;

use super::Answer;
use super::diagnose::watched;
use crate::failure::Failure;
use crate::input::NamedPlant;

/// What is asked.
pub(crate) struct Task {
    pub(crate) plant: NamedPlant,
    pub(crate) log: Recording,
    /// Ids of the effects: several to be told apart, one to be shown.
    pub(crate) effects: Vec<String>,
    pub(crate) limits: Limits,
}

/// The experiment with the plant that it is for.
pub(crate) struct Planned {
    pub(crate) plant: NamedPlant,
    pub(crate) next: NextExperiment,
}

/// Fits the effects, and tries the manoeuvres.
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
        Answer::of(self.next.tells_apart())
    }
}
