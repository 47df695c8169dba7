//! Diagnosis of the missing physical effect, and refinement of the plant.

use core::ops::ControlFlow;
use std::path::Path;

use model_lab::diagnosis::result::{StepKind, Verdict};
use model_lab::diagnosis::{
    Determination, Diagnosis, EstimatedParameter, EstimatedPlant as Estimated, Progress as Stage,
    Refined, WithMissingFlow, diagnose, estimate as estimate_parameters, refine as fit,
};
use recording::Recording;
use report::NextCommand;

use super::Answer;
use crate::failure::Failure;
use crate::input::NamedPlant;
use crate::interrupt;
use crate::options::Options;
use crate::progress::Progress;

/// Logs and plant to explain.
pub(crate) struct Task {
    pub(crate) plant: NamedPlant,
    pub(crate) logs: Vec<Recording>,
    pub(crate) check: Vec<Recording>,
    /// Options that name all inputs, in the form of a command line.
    pub(crate) options: Options,
}

/// Requested effect: its id, and the form of its law.
pub(crate) type Asked = (String, Option<String>);

/// Diagnosis with its inputs.
pub(crate) struct Diagnosed {
    pub(crate) task: Task,
    pub(crate) diagnosis: Diagnosis,
}

/// Refined plant with its inputs.
pub(crate) struct RefinedPlant {
    pub(crate) task: Task,
    pub(crate) refined: Refined,
}

/// Plant with estimated parameters, and its inputs.
pub(crate) struct EstimatedPlant {
    pub(crate) task: Task,
    pub(crate) estimated: Estimated,
}

/// Tries the effects of the library.
pub(crate) fn run(task: Task) -> Result<Diagnosed, Failure> {
    let diagnosis =
        watched(|watch| diagnose(&task.plant.parameters, &task.logs, &task.check, watch))?;
    Ok(Diagnosed { task, diagnosis })
}

/// Adds the effects of `add` and fits.
pub(crate) fn refine(task: Task, add: &[Asked]) -> Result<RefinedPlant, Failure> {
    let refined =
        watched(|watch| fit(&task.plant.parameters, &task.logs, &task.check, add, watch))?;
    Ok(RefinedPlant { task, refined })
}

/// Estimates the ordinary parameters.
pub(crate) fn estimate(task: Task) -> Result<EstimatedPlant, Failure> {
    let estimated = watched(|watch| {
        estimate_parameters(&task.plant.parameters, &task.logs, &task.check, watch)
    })?;
    Ok(EstimatedPlant { task, estimated })
}

/// Runs long work with a progress bar; Ctrl-C ends it at once.
pub(super) fn watched<T, E>(
    work: impl FnOnce(&(dyn Fn(Stage) -> ControlFlow<()> + Sync)) -> Result<T, E>,
) -> Result<T, Failure>
where
    Failure: From<E>,
{
    let progress = Progress::of_stages();
    let done = interrupt::at_once(|| {
        work(&|stage| {
            progress.reach(stage.stage, stage.done);
            ControlFlow::Continue(())
        })
    })?;
    Ok(done?)
}

/// File that the proposed command writes.
const REFINED_FILE: &str = "refined.toml";

impl Diagnosed {
    pub(crate) fn answer(&self) -> Answer {
        match self.diagnosis.verdict {
            Verdict::Adequate => Answer::Holds,
            Verdict::PlantFileWrong => Answer::PlantFileWrong,
            Verdict::Found | Verdict::FormWrong | Verdict::NotInLibrary => Answer::DoesNotHold,
        }
    }

    /// Returns the command that adds the named effects and frees the wrong values of the plant file; `None` if nothing is found.
    pub(crate) fn next_command(&self) -> Option<NextCommand> {
        let given = self.task.options.as_given();
        let steps = &self.diagnosis.error_steps;
        let is_beyond = steps
            .iter()
            .any(|step| step.kind == StepKind::RangesWidened);
        if is_beyond && self.diagnosis.verdict == Verdict::Found {
            return Some(NextCommand {
                // Values first: an effect fitted beside wrong values would compensate for them.
                purpose: "estimate the parameters, then diagnose again",
                command: format!("retarder refine{given} --out {REFINED_FILE}"),
            });
        }
        let added: Vec<String> = steps
            .iter()
            .filter_map(|step| Some((step.added.as_ref()?, step.variant.as_ref()?)))
            .map(|(id, variant)| format!(" --add {id}:{variant}"))
            .collect();
        let outside = self.diagnosis.outside.iter();
        let freed: Vec<String> = outside
            .map(|value| format!(" --free {}", value.name))
            .collect();
        let purpose = match (added.len(), freed.len()) {
            (0, 0) => return self.keeping_flow(&given),
            (0, _) => "correct the plant file",
            (1, 0) => "add the effect to the plant file",
            (_, 0) => "add the effects to the plant file",
            (1, _) => "add the effect to the plant file and correct it",
            (_, _) => "add the effects to the plant file and correct it",
        };
        let (added, freed) = (added.concat(), freed.concat());
        Some(NextCommand {
            purpose,
            command: format!("retarder refine{given}{added}{freed} --out {REFINED_FILE}"),
        })
    }
}

/// File that the proposed command writes, with the missing flow.
const FLOW_FILE: &str = "with-flow.toml";

impl Diagnosed {
    /// Returns the plant with the missing flow as an effect that it may have; `None` if no flow that depends on the chamber pressure
    /// remains.
    pub(crate) fn with_missing_flow(&self) -> Option<WithMissingFlow> {
        WithMissingFlow::of(&self.diagnosis, &self.task.plant.parameters)
    }

    /// Returns the command that keeps the missing flow; `None` if there is none.
    fn keeping_flow(&self, given: &str) -> Option<NextCommand> {
        self.with_missing_flow()?;
        Some(NextCommand {
            purpose: "keep the missing flow as an effect of your own",
            command: format!("retarder diagnose{given} --missing-flow {FLOW_FILE}"),
        })
    }

    /// Returns the command that adds the missing flow in the file `plant` to the named effects; `None` if there is none.
    pub(crate) fn adding_flow(&self, plant: &Path) -> Option<NextCommand> {
        let with = self.with_missing_flow()?;
        let options = self.task.options.with_plant(plant);
        let steps = self.diagnosis.error_steps.iter();
        let named = steps.filter_map(|step| Some((step.added.as_ref()?, step.variant.as_ref()?)));
        let named: String = named
            .map(|(id, variant)| format!(" --add {id}:{variant}"))
            .collect();
        let effect = with.effect;
        Some(NextCommand {
            purpose: "fit the missing flow",
            command: format!("retarder refine{options}{named} --add {effect} --out {REFINED_FILE}"),
        })
    }
}

/// File that the proposed experiment is written to.
const EXPERIMENT_FILE: &str = "next.csv";

impl EstimatedPlant {
    /// Returns the next commands, each with its reason, for a plant written to the file `plant`.
    pub(crate) fn next_commands(&self, plant: &Path) -> Vec<(String, &'static str)> {
        let options = &self.task.options;
        let estimation = &self.estimated.estimation;
        let diagnose = format!("retarder diagnose{}", options.with_plant(plant));
        if !estimation.is_converged {
            let again = format!("retarder refine{}", options.with_plant_anew(plant));
            return vec![(again, "go on with the fit")];
        }
        if !estimation.is_adequate && estimation.explains_fitted_logs {
            let with_all = options.with_plant_anew_and_all_logs(plant);
            let with_all = format!("retarder refine{with_all}");
            return vec![(with_all, "fit what the first log leaves open")];
        }
        if !estimation.is_adequate {
            return vec![(diagnose, "which physical effect is missing?")];
        }
        let is_open = |one: &&EstimatedParameter| {
            matches!(
                one.determination,
                Determination::OnlyTogetherWith { .. } | Determination::NotExcited
            )
        };
        let open = estimation.parameters.iter().filter(is_open);
        let open: String = open
            .map(|parameter| format!(" --determine {}", parameter.name))
            .collect();
        let mut commands = vec![(diagnose, "is anything missing?")];
        if !open.is_empty() {
            let options = options.with_plant_and_one_log(plant);
            let experiment =
                format!("retarder next-experiment{options}{open} --out {EXPERIMENT_FILE}");
            commands.push((experiment, "what would determine the rest?"));
        }
        commands
    }
}
