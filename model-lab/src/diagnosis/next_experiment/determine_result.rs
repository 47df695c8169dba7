//! The experiment that determines parameters, as it stands in its JSON.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::result::{Limits, Phase, rows};

/// Name and version of the JSON format.
pub const DETERMINING_EXPERIMENT_SCHEMA: &str = "retarder.determining-experiment/1";

/// The experiment that determines parameters which the plant file leaves open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeterminingExperiment {
    /// Name and version of this format, `retarder.determining-experiment/1`.
    pub schema: String,
    /// Sources of the logs that say how noisy the signals are.
    pub logs: Vec<String>,
    /// Whether the plant as given leaves no more than the noise on these logs. If not, the foreseen intervals are those of a plant
    /// that does.
    pub is_adequate: bool,
    /// The limits that every manoeuvre keeps.
    pub limits: Limits,
    /// Interval of the commands (s): the sample time of the plant's ECU.
    pub sample_time_s: f64,
    /// The answer in words.
    pub sentence: String,
    /// The parameters in question, with what the best manoeuvre makes of them.
    pub parameters: Vec<ForeseenParameter>,
    /// Manoeuvres that could be simulated, the best first.
    pub ranking: Vec<DeterminingManoeuvre>,
    /// Duty cycles of the best one.
    pub sequence: Vec<Phase>,
}

/// A parameter, as known now and after the best manoeuvre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForeseenParameter {
    /// Name in the plant file.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Value of the plant file.
    pub value: f64,
    /// Least and largest value now: what the plant file says.
    pub now: [f64; 2],
    /// Foreseen 95 % interval after the best manoeuvre.
    pub after: [f64; 2],
    /// Whether the plant file determines it.
    pub is_determined_now: bool,
    /// Whether the best manoeuvre would.
    pub is_determined_after: bool,
    /// What else would determine it; null if the best manoeuvre does.
    pub determined_by: Option<String>,
}

/// What the rig could do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeterminingManoeuvre {
    /// Its name.
    pub name: String,
    /// What it shows.
    pub about: String,
    /// Its length (s).
    pub duration_s: f64,
    /// Highest chamber pressure in the model (bar gauge).
    pub highest_bar: f64,
    /// Names of the parameters that it would determine and the plant file does not.
    pub determines: Vec<String>,
    /// Width of the intervals afterwards over that now: geometric mean over the parameters that the plant file leaves open.
    pub width_after: f64,
}

impl DeterminingExperiment {
    /// The JSON Schema of such an experiment.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }

    /// Whether all parameters are determined once the best manoeuvre was run.
    pub fn determines_all(&self) -> bool {
        self.parameters.iter().all(|one| one.is_determined_after)
    }

    /// The best manoeuvre as a log of commands, one row per ECU sample: `time_s,duty_fill_pct,duty_vent_pct`.
    pub fn csv(&self) -> String {
        let end_s = self.ranking.first().map_or(0.0, |best| best.duration_s);
        rows(&self.sequence, end_s, self.sample_time_s)
    }
}
