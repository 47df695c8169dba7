//! What goes into a report.

use hil_harness::rigs::RigVerdict;
use hil_harness::{Requirement, Verdict};
use model_lab::Comparison;
use model_lab::diagnosis::Diagnosis;
use model_lab::thesis::ThesisTable;
use recording::{Provenance, Recording};

/// Everything a report tells. A part that was not run is left out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contents<'a> {
    /// First line of the page.
    pub(crate) title: &'a str,
    /// Model against measurement.
    pub(crate) model: Option<ModelPart<'a>>,
    /// Which physical effect is missing.
    pub(crate) diagnosis: Option<DiagnosisPart<'a>>,
    /// The closed loop on the model, one part per scenario.
    pub(crate) control: &'a [ControlPart<'a>],
    /// The thesis' own figures.
    pub(crate) thesis: Option<&'a ThesisTable>,
    /// What to try next, one sentence or command each.
    pub(crate) next_steps: &'a [String],
    /// Where all of it comes from.
    pub(crate) origin: Origin<'a>,
}

/// A log, and how the model compares with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelPart<'a> {
    /// What was measured and commanded.
    pub(crate) log: &'a Recording,
    /// The result, with its traces.
    pub(crate) comparison: &'a Comparison,
}

/// What the model lacks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DiagnosisPart<'a> {
    /// The result.
    pub(crate) diagnosis: &'a Diagnosis,
    /// The worst log with the plain and with the refined model; none where no effect is named.
    pub(crate) runs: Option<&'a BeforeAndAfter<'a>>,
    /// The command that adds what is named.
    pub(crate) next_command: Option<&'a str>,
}

/// A log, with two models.
#[derive(Clone, Debug)]
pub(crate) struct BeforeAndAfter<'a> {
    /// What was measured and commanded.
    pub(crate) log: &'a Recording,
    /// With the plain model, refitted.
    pub(crate) before: Comparison,
    /// With the named effects.
    pub(crate) after: Comparison,
}

/// A run of the closed loop, and how it was judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ControlPart<'a> {
    /// All signals of the run.
    pub(crate) recording: &'a Recording,
    /// What was asked for.
    pub(crate) requirement: &'a Requirement,
    /// What was reached.
    pub(crate) verdict: &'a Verdict,
    /// Which plant was controlled.
    pub(crate) plant: &'a str,
    /// Which controller did it.
    pub(crate) controller: &'a str,
    /// The same on scattered rigs; empty where none was asked for.
    pub(crate) rigs: &'a [RigVerdict],
}

/// Where a report comes from, so that another person gets the same one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Origin<'a> {
    /// The command, as it was typed.
    pub(crate) command_line: &'a str,
    /// Every file that was read.
    pub(crate) inputs: &'a [Input],
    /// Programs and models with their versions.
    pub(crate) versions: &'a [(String, String)],
}

/// The identity of an input file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Input {
    /// What it is for: `log`, `plant`, `controller`.
    pub(crate) role: String,
    /// Its name.
    pub(crate) name: String,
    /// Size in bytes and SHA-256 in hexadecimal digits; none for what is built in.
    pub(crate) identity: Option<(u64, String)>,
}

impl Input {
    /// The input that a recording was read from.
    pub(crate) fn of_recording(role: impl Into<String>, provenance: &Provenance) -> Self {
        Self {
            role: role.into(),
            name: provenance.source.clone(),
            identity: provenance
                .input
                .map(|file| (file.size_bytes, file.sha256_hex())),
        }
    }
}
