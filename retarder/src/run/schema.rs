//! JSON Schemas of all results.

use hil_harness::checks::{Bound as HarnessBound, CheckId as HarnessCheckId};
use model_lab::Comparison;
use model_lab::thesis::ThesisTable;
use schemars::{JsonSchema, Schema, schema_for};

use super::control::Rigs;
use super::simulate::Simulation;
use crate::cli::SchemaName;

/// The schema of a result.
pub(crate) fn of(result: SchemaName) -> Schema {
    match result {
        SchemaName::Comparison => Comparison::json_schema(),
        SchemaName::Control => schema_for!(Verdict),
        SchemaName::Rigs => schema_for!(Rigs),
        SchemaName::Simulation => schema_for!(Simulation),
        SchemaName::Thesis => schema_for!(ThesisTable),
    }
}

/// How the loop stands against the requirement.
#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(
    dead_code,
    reason = "the form of hil-harness' verdict; a test holds real verdicts against its schema"
)]
pub(crate) struct Verdict {
    /// Name and version of this format.
    schema: String,
    /// Source of the recording.
    source: String,
    /// Whether every binding check holds, and at least one step was judged.
    holds: bool,
    /// The checks that the recording gives occasion to.
    checks: Vec<Check>,
    /// The checks that it gives none to; neither held nor broken.
    not_exercised: Vec<CheckId>,
    /// Each judged step of the reference.
    steps: Vec<StepResponse>,
    /// How often the valves moved; null where it was not logged.
    actuations: Option<Actuations>,
}

/// How often the valves moved in the whole recording.
#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "as for the verdict")]
struct Actuations {
    /// Fill valve.
    fill: u32,
    /// Vent valve.
    vent: u32,
    /// Both, per second of the recording.
    per_s: f64,
}

/// One requirement and what was reached.
#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "as for the verdict")]
struct Check {
    /// Which check.
    id: CheckId,
    /// The requirement in words, with its source.
    requirement: String,
    /// How `reached` is compared with `limit`.
    bound: Bound,
    /// The limit, in `unit`.
    limit: f64,
    /// The worst that was reached, in `unit`; null if it was never reached.
    reached: Option<f64>,
    /// Unit of `limit` and `reached`.
    unit: String,
    /// Whether `reached` respects `limit`.
    holds: bool,
    /// Whether the thesis requires it. What is not binding does not decide `holds` of the verdict.
    binding: bool,
    /// Where the worst occurred, or how much was looked at.
    evidence: String,
}

/// Answer to one step of the reference that was then held; samples count from the step.
#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "as for the verdict")]
struct StepResponse {
    /// Instant of the step, s.
    time_s: f64,
    /// Index of the step's sample in the recording.
    index: usize,
    /// The reference before the step, bar gauge.
    previous_bar: f64,
    /// Chamber pressure at the step, bar gauge.
    from_bar: f64,
    /// The new reference, bar gauge.
    to_bar: f64,
    /// Whether the retarder uses the new reference.
    in_operating_range: bool,
    /// How long the reference was held, samples.
    held_samples: u32,
    /// First sample within the tolerance; null if never.
    reached_samples: Option<u32>,
    /// First sample from which on the pressure stayed within the tolerance; null if never.
    settled_samples: Option<u32>,
    /// How far the pressure went beyond the reference, bar.
    overshoot_bar: f64,
    /// Largest magnitude of the error after T_req, bar.
    steady_error_bar: f64,
}

/// Which check.
struct CheckId;

impl JsonSchema for CheckId {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "CheckId".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "type": "string",
            "enum": HarnessCheckId::ALL.map(HarnessCheckId::name),
        })
    }
}

/// How a value respects its limit.
struct Bound;

impl JsonSchema for Bound {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Bound".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "type": "string",
            "enum": [HarnessBound::AtMost, HarnessBound::LessThan],
        })
    }
}
