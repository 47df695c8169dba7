//! Report of a whole session: logs, comparisons, diagnosis, and the loop on the plant as given and as refined.

use std::sync::atomic::AtomicBool;

use hil_harness::{OperatingConditions, Scenario};
use model_lab::CompareOptions;
use plant_sim::PlantParameters;
use report::Input;

use super::Answer;
use super::compare::{self, Compared};
use super::control::{self, Controlled};
use super::diagnose::{self, Diagnosed};
use crate::cli::ReportPart;
use crate::failure::Failure;
use crate::input::{self, NamedController, NamedPlant, NamedRequirement, NamedScenario};
use crate::interrupt;

/// Contents of the report.
pub(crate) struct Task {
    /// Plant and logs.
    pub(crate) subject: diagnose::Task,
    pub(crate) controller: NamedController,
    pub(crate) scenario: Scenario,
    pub(crate) rigs: u32,
    pub(crate) conditions: OperatingConditions,
    pub(crate) requirements: NamedRequirement,
    pub(crate) without: Vec<ReportPart>,
}

/// Results of a whole session.
pub(crate) struct Reported {
    pub(crate) plant: NamedPlant,
    /// All logs, validation logs last.
    pub(crate) compared: Vec<Compared>,
    pub(crate) diagnosed: Option<Diagnosed>,
    /// Loop on the plant, then on the plant with the named effects.
    pub(crate) loops: Vec<Controlled>,
    /// Parts that were left out, with the reason.
    pub(crate) not_run: Vec<String>,
    pub(crate) inputs: Vec<Input>,
}

/// Runs every part that the plant description allows.
pub(crate) fn run(task: Task) -> Result<Reported, Failure> {
    interrupt::at_once(|| parts(task))?
}

fn parts(task: Task) -> Result<Reported, Failure> {
    let Task {
        subject,
        controller,
        scenario,
        rigs,
        conditions,
        requirements,
        without,
    } = task;
    let plant = subject.plant.clone();
    let mut inputs = inputs(&subject, &controller);
    inputs.extend(requirements.input());
    let compared = subject
        .logs
        .iter()
        .chain(&subject.check)
        .map(|log| {
            let options = CompareOptions::default();
            compare::run(plant.clone(), log.clone(), &options, None)
        })
        .collect::<Result<_, _>>()?;
    let diagnosed = if without.contains(&ReportPart::Diagnosis) {
        None
    } else {
        Some(diagnose::run(subject)?)
    };
    let mut not_run = Vec::new();
    let mut loops = Vec::new();
    if !without.contains(&ReportPart::Control) {
        // No file is being written yet: Ctrl-C ends the process.
        let never = AtomicBool::new(false);
        match plant.clone().for_control() {
            Ok(whole) => {
                let on = |name: String, parameters: PlantParameters| {
                    let scenario = scenario
                        .clone()
                        .on(parameters)
                        .controlled_by(controller.settings);
                    let scenario = NamedScenario {
                        plant: name,
                        controller: controller.name.clone(),
                        inputs: Vec::new(),
                        scenario: input::under(conditions, scenario)?,
                        conditions,
                        requirements: requirements.clone(),
                    };
                    control::run(scenario, rigs, &never)
                };
                loops.push(on(whole.name.clone(), whole.parameters)?);
                if let Some((name, refined)) = diagnosed.as_ref().and_then(refined) {
                    loops.push(on(name, refined)?);
                }
            }
            Err(reason) => not_run.push(format!("the closed loop was left out: {reason}")),
        }
    }
    Ok(Reported {
        plant,
        compared,
        diagnosed,
        loops,
        not_run,
        inputs,
    })
}

fn inputs(subject: &diagnose::Task, controller: &NamedController) -> Vec<Input> {
    let of_log = |role: &'static str| {
        move |log: &recording::Recording| Input::of_recording(role, log.provenance())
    };
    let logs = subject.logs.iter().map(of_log("log"));
    let check = subject.check.iter().map(of_log("check"));
    logs.chain(check)
        .chain([subject.plant.input(), controller.input()])
        .collect()
}

/// Returns the plant with the named effects and its name; `None` if no effect is named.
fn refined(diagnosed: &Diagnosed) -> Option<(String, PlantParameters)> {
    let effects = &diagnosed.diagnosis.effects;
    if effects.is_empty() {
        return None;
    }
    let plant = &diagnosed.task.plant;
    let [_, refined] = diagnosed.diagnosis.plain_and_refined(&plant.parameters);
    Some((
        format!("{} with {}", plant.name, effects.join(", ")),
        refined,
    ))
}

impl Reported {
    /// Returns whether the model is within tolerance on every log, no effect is missing, and the loop meets its
    /// requirements.
    pub(crate) fn answer(&self) -> Answer {
        let mut answers: Vec<Answer> = self.compared.iter().map(Compared::answer).collect();
        answers.extend(self.diagnosed.as_ref().map(Diagnosed::answer));
        answers.extend(self.loops.iter().map(|run| Answer::of(run.holds())));
        let fails = [Answer::DoesNotHold, Answer::PlantFileWrong];
        if answers.iter().any(|answer| fails.contains(answer)) {
            Answer::DoesNotHold
        } else if answers.contains(&Answer::Open) {
            Answer::Open
        } else {
            Answer::Holds
        }
    }
}
