//! Contents of a report.

use hil_harness::gain_search::Found;
use hil_harness::rigs::RigVerdict;
use hil_harness::{Requirement, Verdict};
use model_lab::diagnosis::Diagnosis;
use model_lab::thesis::ThesisTable;
use model_lab::{CompareOptions, Comparison, LogConditions, compare, compare_under};
use plant_sim::PlantParameters;
use recording::{Provenance, Recording};

/// All contents of a report. A part that was not run is left out.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contents<'a> {
    /// First line of the page.
    pub title: &'a str,
    /// Opened logs, readable or not.
    pub logs: &'a [LogPart<'a>],
    /// Plant that the logs are compared with.
    pub plant: Option<PlantPart<'a>>,
    /// Model compared with measurement, one part per log.
    pub models: &'a [ModelPart<'a>],
    /// Diagnosis of the missing physical effect.
    pub diagnosis: Option<DiagnosisPart<'a>>,
    /// Refinement steps of the plant.
    pub history: Option<HistoryPart<'a>>,
    /// Closed loop on the model, one part per scenario.
    pub control: &'a [ControlPart<'a>],
    /// Search of gains.
    pub tuning: Option<TuningPart<'a>>,
    /// Figures of the thesis, measured and simulated.
    pub thesis: Option<&'a ThesisTable>,
    /// Next steps to try, one sentence or command each.
    pub next_steps: &'a [String],
    /// Sources of the report.
    pub origin: Origin<'a>,
}

/// Log that was opened.
#[derive(Clone, Copy, Debug)]
pub struct LogPart<'a> {
    /// Name.
    pub name: &'a str,
    /// Recording; `None` if the log cannot be read.
    pub recording: Option<&'a Recording>,
    /// Problems of the log, one sentence each.
    pub problems: &'a [String],
}

/// Plant.
#[derive(Clone, Copy, Debug)]
pub struct PlantPart<'a> {
    /// Name.
    pub name: &'a str,
    /// Parameters and effects.
    pub parameters: &'a PlantParameters,
}

/// Log and its comparison with the model.
#[derive(Clone, Copy, Debug)]
pub struct ModelPart<'a> {
    /// Measurement and commands.
    pub log: &'a Recording,
    /// Result with its traces.
    pub comparison: &'a Comparison,
    /// Whether a diagnosis explains the error of the plant: a signal above its limit is then no failure.
    pub is_explained: bool,
}

/// Diagnosis and its plots.
#[derive(Clone, Copy, Debug)]
pub struct DiagnosisPart<'a> {
    /// Result.
    pub diagnosis: &'a Diagnosis,
    /// Log with the largest error, with the plain and with the refined model.
    pub runs: Option<&'a BeforeAndAfter<'a>>,
    /// Command to run next; `None` if nothing is found.
    pub next_command: Option<&'a NextCommand>,
}

/// Command to run after a diagnosis.
#[derive(Clone, Debug)]
pub struct NextCommand {
    /// Purpose, such as `add the effect to the plant file`.
    pub purpose: &'static str,
    /// Command line.
    pub command: String,
}

/// Log with two models.
#[derive(Clone, Debug)]
pub struct BeforeAndAfter<'a> {
    /// Measurement and commands.
    pub log: &'a Recording,
    /// Comparison with the plain model, refitted.
    pub before: Comparison,
    /// Comparison with the named effects and the values outside the ranges of the plant file; `None` if there is neither.
    pub after: Option<Comparison>,
}

impl<'a> BeforeAndAfter<'a> {
    /// Returns the log of `logs` with the largest error of `plant`, refitted; `None` if none can be compared.
    pub fn worst(
        diagnosis: &Diagnosis,
        plant: &PlantParameters,
        logs: &[&'a Recording],
    ) -> Option<Self> {
        let [plain, refined] = diagnosis.plain_and_refined(plant);
        let fitted = |log: &Recording| diagnosis.conditions.get(&log.provenance().source);
        let runs = logs.iter().filter_map(|&log| {
            let conditions = fitted(log).map(|fitted| &fitted.plain);
            Some((log, compared(&plain, log, conditions)?))
        });
        let (log, before) = runs.max_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)))?;
        let is_refined = !(diagnosis.effects.is_empty() && diagnosis.outside.is_empty());
        let after = match is_refined {
            true => {
                let conditions = fitted(log).map(|fitted| &fitted.refined);
                Some(compared(&refined, log, conditions)?)
            }
            false => None,
        };
        Some(Self { log, before, after })
    }
}

/// Compares `plant` with `log` under `conditions`, or under those that are found where none are known. Returns none if the log cannot be
/// compared.
fn compared(
    plant: &PlantParameters,
    log: &Recording,
    conditions: Option<&LogConditions>,
) -> Option<Comparison> {
    let options = CompareOptions::default();
    match conditions {
        Some(conditions) => compare_under(plant, log, conditions, &options, &|_| true).ok(),
        None => compare(plant, log, &options).ok(),
    }
}

/// Returns the error of the worst signal, as a multiple of its noise.
fn distance(comparison: &Comparison) -> f64 {
    let multiples = comparison
        .signals
        .iter()
        .filter_map(|signal| signal.free_run.rms_in_noise);
    multiples.fold(0.0, f64::max)
}

/// Refinement steps of a plant, oldest first.
#[derive(Clone, Copy, Debug)]
pub struct HistoryPart<'a> {
    /// Steps; those after `current` were undone.
    pub steps: &'a [HistoryStep],
    /// Index of the current step.
    pub current: usize,
}

/// Step of a refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryStep {
    /// Change, such as "chamber_leak added".
    pub what: String,
    /// Log of the errors; empty if there are none.
    pub log: String,
    /// Error of each signal after the step, in the unit of the signal (rms), and the noise floor if known.
    pub errors: Vec<(String, f64, Option<f64>)>,
}

/// Run of the closed loop and its verdict.
#[derive(Clone, Copy, Debug)]
pub struct ControlPart<'a> {
    /// All signals of the run.
    pub recording: &'a Recording,
    /// Requirement.
    pub requirement: &'a Requirement,
    /// Verdict.
    pub verdict: &'a Verdict,
    /// Name of the plant.
    pub plant: &'a str,
    /// Name of the controller.
    pub controller: &'a str,
    /// Operating conditions that differ from those of the plant, and other requirements, in sentences; may be empty.
    pub conditions: &'a str,
    /// Verdicts on scattered rigs; empty if none were requested.
    pub rigs: &'a [RigVerdict],
}

/// Search of gains for a plant.
#[derive(Clone, Copy, Debug)]
pub struct TuningPart<'a> {
    /// Name of the plant.
    pub plant: &'a str,
    /// Name of the controller that was tuned.
    pub controller: &'a str,
    /// Requirement that the candidates are judged by.
    pub requirement: &'a Requirement,
    /// Result.
    pub found: &'a Found,
}

/// Sources of a report, from which it can be reproduced.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin<'a> {
    /// Command as it was typed.
    pub command_line: &'a str,
    /// All files that were read.
    pub inputs: &'a [Input],
    /// Programs and models with their versions.
    pub versions: &'a [(String, String)],
}

/// Identity of an input file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// Role: `log`, `plant`, `controller`.
    pub role: String,
    /// Name.
    pub name: String,
    /// Size in bytes and SHA-256 in hexadecimal digits; `None` for built-in inputs.
    pub identity: Option<(u64, String)>,
}

impl Input {
    /// Returns the input that a recording was read from.
    pub fn of_recording(role: impl Into<String>, provenance: &Provenance) -> Self {
        Self {
            role: role.into(),
            name: provenance.source.clone(),
            identity: provenance
                .input
                .map(|file| (file.size_bytes, file.sha256_hex())),
        }
    }
}
