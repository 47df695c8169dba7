//! What goes into a report.

use hil_harness::{Requirement, Verdict};
use model_lab::Comparison;
use model_lab::thesis::ThesisTable;
use recording::{Provenance, Recording};

/// Everything a report tells. A part that was not run is left out.
#[derive(Clone, Copy, Debug)]
pub struct Contents<'a> {
    /// First line of the page.
    pub title: &'a str,
    /// Model against measurement.
    pub model: Option<ModelPart<'a>>,
    /// The closed loop on the model.
    pub control: Option<ControlPart<'a>>,
    /// The thesis' own figures.
    pub thesis: Option<&'a ThesisTable>,
    /// What to try next, one sentence or command each.
    pub next_steps: &'a [String],
    /// Where all of it comes from.
    pub origin: Origin<'a>,
}

/// A log, and how the model compares with it.
#[derive(Clone, Copy, Debug)]
pub struct ModelPart<'a> {
    /// What was measured and commanded.
    pub log: &'a Recording,
    /// The result, with its traces.
    pub comparison: &'a Comparison,
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
