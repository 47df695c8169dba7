//! Conversion of outcomes into contents of the HTML report.

use recording::Recording;
use report::{
    BeforeAndAfter, Contents, ControlPart, DiagnosisPart, Input, LogPart, ModelPart, Origin,
    PlantPart, TuningPart,
};

use crate::run::Outcome;
use crate::run::compare::Compared;
use crate::run::control::Controlled;
use crate::run::diagnose::Diagnosed;
use crate::run::session::Reported;
use crate::run::thesis::Figures;
use crate::shell::quoted;

/// Commands to try after the demo, with the reason.
pub(crate) const NEXT_STEPS: [[&str; 2]; 7] = [
    [
        "retarder compare --log data/synthetic/practice-00-id.csv",
        "another rig",
    ],
    [
        "retarder compare --log YOUR-LOG.csv --html comparison.html",
        "your own bench: a CSV file with columns such as time_s, duty_fill_pct, duty_vent_pct, p_ch_bar_gauge",
    ],
    [
        "retarder parameters --toml > my-plant.toml",
        "a plant file to change; then compare --plant my-plant.toml",
    ],
    [
        "retarder control --controller thesis",
        "the loop with the thesis' own controller",
    ],
    [
        "retarder control --rigs 100",
        "robustness (Monte Carlo): the loop on a hundred trucks: real valves, 18 to 32 V, -40 to 120 °C",
    ],
    [
        "retarder thesis",
        "the figures of the thesis, measured and simulated",
    ],
    ["retarder --help", "the rest"],
];

/// Returns the report, or `None` if the outcome has none.
pub(crate) fn html(outcome: &Outcome) -> Option<String> {
    Some(match outcome {
        Outcome::Demo(demo) => {
            let next_steps = NEXT_STEPS.map(|[command, reason]| format!("{command}: {reason}"));
            let inputs = [
                vec![
                    Input::of_recording("log", demo.compared.log.provenance()),
                    demo.compared.plant.input(),
                ],
                demo.loops
                    .iter()
                    .flat_map(|run| run.scenario.inputs.clone())
                    .collect(),
            ]
            .concat();
            page(&Page {
                title: "A demo: model, bench and loop",
                compared: std::slice::from_ref(&demo.compared),
                loops: &demo.loops,
                figures: Some(&demo.figures),
                next_steps: &next_steps,
                inputs: &inputs,
                ..Page::default()
            })
        }
        Outcome::Comparison(compared) => page(&Page {
            title: &format!(
                "{} compared with {}",
                compared.plant.name, compared.comparison.log
            ),
            compared: std::slice::from_ref(compared),
            inputs: &[
                Input::of_recording("log", compared.log.provenance()),
                compared.plant.input(),
            ],
            ..Page::default()
        }),
        Outcome::Control(controlled) => page(&Page {
            title: &format!(
                "{}: {}",
                controlled.scenario.scenario.name, controlled.scenario.controller
            ),
            loops: std::slice::from_ref(controlled),
            inputs: &controlled.scenario.inputs,
            ..Page::default()
        }),
        Outcome::Thesis(figures) => page(&Page {
            title: &format!("The figures of the thesis and the {}", figures.plant.name),
            figures: Some(figures),
            inputs: &[figures.plant.input()],
            ..Page::default()
        }),
        Outcome::Tuned(tuned) => {
            let found = &tuned.searched.as_ref()?.found;
            let task = &tuned.task;
            page(&Page {
                title: &format!("Gains for {}", task.plant.name),
                tuning: Some(TuningPart {
                    plant: &task.plant.name,
                    controller: &task.controller.name,
                    requirement: &task.requirements.requirement,
                    found,
                }),
                inputs: &[
                    Some(task.plant.input()),
                    Some(task.controller.input()),
                    task.requirements.input(),
                ]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>(),
                ..Page::default()
            })
        }
        Outcome::Diagnosis(diagnosed) => diagnosis(diagnosed),
        Outcome::Report(reported) => session(reported),
        Outcome::Simulation(_)
        | Outcome::Estimation(_)
        | Outcome::Refinement(_)
        | Outcome::ThesisExplanation(_)
        | Outcome::NextExperiment(_)
        | Outcome::DeterminingExperiment(_)
        | Outcome::Parameters(_)
        | Outcome::Settings(_)
        | Outcome::BlackBox(_)
        | Outcome::DeviceSettings(_)
        | Outcome::DeviceSignals
        | Outcome::Measurement(_)
        | Outcome::Inspection(_)
        | Outcome::RigTable(_)
        | Outcome::Text(_) => return None,
    })
}

fn diagnosis(diagnosed: &Diagnosed) -> String {
    let task = &diagnosed.task;
    let sources: Vec<&str> = task
        .logs
        .iter()
        .map(|log| log.provenance().source.as_str())
        .collect();
    page(&Page {
        title: &format!(
            "{} compared with {}: what is missing?",
            task.plant.name,
            sources.join(", ")
        ),
        diagnosis: Some(diagnosed),
        inputs: &inputs_of(diagnosed),
        ..Page::default()
    })
}

/// Returns all files that a diagnosis reads.
fn inputs_of(diagnosed: &Diagnosed) -> Vec<Input> {
    let task = &diagnosed.task;
    let of = |role: &'static str, logs: &[Recording]| -> Vec<Input> {
        logs.iter()
            .map(|log| Input::of_recording(role, log.provenance()))
            .collect()
    };
    let plant = vec![task.plant.input()];
    [of("log", &task.logs), of("check", &task.check), plant].concat()
}

/// Returns the report of a whole session, in one file.
fn session(reported: &Reported) -> String {
    let logs: Vec<LogPart<'_>> = reported
        .compared
        .iter()
        .map(|compared| LogPart {
            name: &compared.comparison.log,
            recording: Some(&compared.log),
            problems: &[],
        })
        .collect();
    let names: Vec<&str> = logs.iter().map(|log| log.name).collect();
    page(&Page {
        title: &format!("{} and {}", reported.plant.name, names.join(", ")),
        logs: &logs,
        plant: Some(PlantPart {
            name: &reported.plant.name,
            parameters: &reported.plant.parameters,
        }),
        compared: &reported.compared,
        diagnosis: reported.diagnosed.as_ref(),
        loops: &reported.loops,
        next_steps: &reported.not_run,
        inputs: &reported.inputs,
        ..Page::default()
    })
}

#[derive(Default)]
struct Page<'a> {
    title: &'a str,
    logs: &'a [LogPart<'a>],
    plant: Option<PlantPart<'a>>,
    compared: &'a [Compared],
    diagnosis: Option<&'a Diagnosed>,
    loops: &'a [Controlled],
    tuning: Option<TuningPart<'a>>,
    figures: Option<&'a Figures>,
    next_steps: &'a [String],
    inputs: &'a [Input],
}

fn page(page: &Page<'_>) -> String {
    let conditions = page.loops.iter().map(|run| run.scenario.conditions_text());
    let conditions: Vec<String> = conditions.collect();
    let control: Vec<ControlPart<'_>> = page
        .loops
        .iter()
        .zip(&conditions)
        .map(|(run, conditions)| ControlPart {
            recording: &run.run.recording,
            requirement: &run.scenario.requirements.requirement,
            verdict: &run.verdict,
            plant: &run.scenario.plant,
            controller: &run.scenario.controller,
            conditions,
            rigs: &run.rigs,
        })
        .collect();
    let is_explained = page
        .diagnosis
        .is_some_and(|diagnosed| diagnosed.diagnosis.explains());
    let models: Vec<ModelPart<'_>> = page
        .compared
        .iter()
        .map(|compared| ModelPart {
            log: &compared.log,
            comparison: &compared.comparison,
            is_explained,
        })
        .collect();
    let runs = page.diagnosis.and_then(before_and_after);
    let next_command = page.diagnosis.and_then(Diagnosed::next_command);
    report::html(&Contents {
        title: page.title,
        logs: page.logs,
        plant: page.plant,
        models: &models,
        diagnosis: page.diagnosis.map(|diagnosed| DiagnosisPart {
            diagnosis: &diagnosed.diagnosis,
            runs: runs.as_ref(),
            next_command: next_command.as_ref(),
        }),
        history: None,
        control: &control,
        tuning: page.tuning,
        thesis: page.figures.map(|figures| &figures.table),
        next_steps: page.next_steps,
        origin: Origin {
            command_line: &command_line(),
            inputs: page.inputs,
            versions: &[("retarder".to_owned(), env!("CARGO_PKG_VERSION").to_owned())],
        },
    })
}

/// Returns the validation log with the largest error of the plain model, with both models; without validation logs, a
/// training log.
fn before_and_after(diagnosed: &Diagnosed) -> Option<BeforeAndAfter<'_>> {
    let task = &diagnosed.task;
    let logs = if task.check.is_empty() {
        &task.logs
    } else {
        &task.check
    };
    let logs: Vec<&Recording> = logs.iter().collect();
    BeforeAndAfter::worst(&diagnosed.diagnosis, &task.plant.parameters, &logs)
}

/// Returns the command as it was typed, without the folder of the program.
fn command_line() -> String {
    let arguments = std::env::args_os()
        .skip(1)
        .map(|argument| quoted(&argument.to_string_lossy()));
    let words: Vec<String> = std::iter::once("retarder".to_owned())
        .chain(arguments)
        .collect();
    words.join(" ")
}
