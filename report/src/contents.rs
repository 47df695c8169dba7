//! What goes into a report.

use hil_harness::rigs::RigVerdict;
use hil_harness::{Requirement, Verdict};
use model_lab::diagnosis::Diagnosis;
use model_lab::thesis::ThesisTable;
use model_lab::{CompareOptions, Comparison, compare};
use plant_sim::PlantParameters;
use recording::{Provenance, Recording};

/// Everything a report tells. A part that was not run is left out.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contents<'a> {
    /// First line of the page.
    pub title: &'a str,
    /// What was opened, readable or not.
    pub logs: &'a [LogPart<'a>],
    /// The plant that the logs are held against.
    pub plant: Option<PlantPart<'a>>,
    /// Model against measurement, one part per log.
    pub models: &'a [ModelPart<'a>],
    /// Which physical effect is missing.
    pub diagnosis: Option<DiagnosisPart<'a>>,
    /// How the plant was refined.
    pub history: Option<HistoryPart<'a>>,
    /// The closed loop on the model, one part per scenario.
    pub control: &'a [ControlPart<'a>],
    /// The thesis' own figures.
    pub thesis: Option<&'a ThesisTable>,
    /// What to try next, one sentence or command each.
    pub next_steps: &'a [String],
    /// Where all of it comes from.
    pub origin: Origin<'a>,
}

/// A log that was opened.
#[derive(Clone, Copy, Debug)]
pub struct LogPart<'a> {
    /// Its name.
    pub name: &'a str,
    /// What was read of it; none if it cannot be read.
    pub recording: Option<&'a Recording>,
    /// What is wrong with it, one sentence each.
    pub problems: &'a [String],
}

/// A plant.
#[derive(Clone, Copy, Debug)]
pub struct PlantPart<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its parameters and effects.
    pub parameters: &'a PlantParameters,
}

/// A log, and how the model compares with it.
#[derive(Clone, Copy, Debug)]
pub struct ModelPart<'a> {
    /// What was measured and commanded.
    pub log: &'a Recording,
    /// The result, with its traces.
    pub comparison: &'a Comparison,
}

/// What the model lacks.
#[derive(Clone, Copy, Debug)]
pub struct DiagnosisPart<'a> {
    /// The result.
    pub diagnosis: &'a Diagnosis,
    /// The worst log with the plain and with the refined model.
    pub runs: Option<&'a BeforeAndAfter<'a>>,
    /// The command that adds what is named.
    pub next_command: Option<&'a str>,
}

/// A log, with two models.
#[derive(Clone, Debug)]
pub struct BeforeAndAfter<'a> {
    /// What was measured and commanded.
    pub log: &'a Recording,
    /// With the plain model, refitted.
    pub before: Comparison,
    /// With the named effects; none where no effect is named.
    pub after: Option<Comparison>,
}

impl<'a> BeforeAndAfter<'a> {
    /// The one of `logs` on which `plant`, refitted, is furthest off; none where none can be compared.
    pub fn worst(
        diagnosis: &Diagnosis,
        plant: &PlantParameters,
        logs: &[&'a Recording],
    ) -> Option<Self> {
        let [plain, refined] = diagnosis.plain_and_refined(plant);
        let against = |plant, log| compare(plant, log, &CompareOptions::default()).ok();
        let runs = logs
            .iter()
            .filter_map(|log| Some((*log, against(&plain, log)?)));
        let (log, before) = runs.max_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)))?;
        let after = match diagnosis.effects.is_empty() {
            true => None,
            false => Some(against(&refined, log)?),
        };
        Some(Self { log, before, after })
    }
}

/// How far off the worst signal is, in multiples of its noise.
fn distance(comparison: &Comparison) -> f64 {
    let multiples = comparison
        .signals
        .iter()
        .filter_map(|signal| signal.free_run.rms_in_noise);
    multiples.fold(0.0, f64::max)
}

/// The steps by which a plant was refined, the first one first.
#[derive(Clone, Copy, Debug)]
pub struct HistoryPart<'a> {
    /// The steps; those after `current` were undone.
    pub steps: &'a [HistoryStep],
    /// Index of the step that the plant stands at.
    pub current: usize,
}

/// One step of a refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryStep {
    /// What was done, such as "chamber_leak added".
    pub what: String,
    /// The log that the errors are of; empty where there are none.
    pub log: String,
    /// Error of each signal after it, in the unit of the signal \[rms\], and the noise floor where it is known.
    pub errors: Vec<(String, f64, Option<f64>)>,
}

/// A run of the closed loop, and how it was judged.
#[derive(Clone, Copy, Debug)]
pub struct ControlPart<'a> {
    /// All signals of the run.
    pub recording: &'a Recording,
    /// What was asked for.
    pub requirement: &'a Requirement,
    /// What was reached.
    pub verdict: &'a Verdict,
    /// Which plant was controlled.
    pub plant: &'a str,
    /// Which controller did it.
    pub controller: &'a str,
    /// The same on scattered rigs; empty where none was asked for.
    pub rigs: &'a [RigVerdict],
}

/// Where a report comes from, so that another person gets the same one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin<'a> {
    /// The command, as it was typed.
    pub command_line: &'a str,
    /// Every file that was read.
    pub inputs: &'a [Input],
    /// Programs and models with their versions.
    pub versions: &'a [(String, String)],
}

/// The identity of an input file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// What it is for: `log`, `plant`, `controller`.
    pub role: String,
    /// Its name.
    pub name: String,
    /// Size in bytes and SHA-256 in hexadecimal digits; none for what is built in.
    pub identity: Option<(u64, String)>,
}

impl Input {
    /// The input that a recording was read from.
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
