//! Experiment that determines parameters, as in its JSON.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::result::{Limits, Phase, rows};

/// Name and version of the JSON format.
pub const DETERMINING_EXPERIMENT_SCHEMA: &str = "retarder.determining-experiment/2";

/// Experiment that determines parameters which the plant file leaves undetermined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeterminingExperiment {
    /// Name and version of this format, `retarder.determining-experiment/2`.
    pub schema: String,
    /// Sources of the logs from which the noise of the signals is known.
    pub logs: Vec<String>,
    /// Whether the plant as given leaves no more than the noise on these logs. If not, the predicted intervals are those of a plant
    /// that does.
    pub is_adequate: bool,
    /// Limits that every excitation satisfies.
    pub limits: Limits,
    /// Interval of the commands (s): the sample time of the plant's ECU.
    pub sample_time_s: f64,
    /// The answer in words.
    pub sentence: String,
    /// Requested parameters, with their intervals before and after the best excitation.
    pub parameters: Vec<ForeseenParameter>,
    /// Excitations that could be simulated, the best first.
    pub ranking: Vec<DeterminingTestSignal>,
    /// Duty cycles of the best excitation.
    pub sequence: Vec<Phase>,
}

/// Parameter, as known now and after the best excitation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForeseenParameter {
    /// Name in the plant file.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Value of the plant file.
    pub value: f64,
    /// Least and largest value now, according to the plant file.
    pub now: [f64; 2],
    /// Predicted 95 % interval after the best excitation.
    pub after: [f64; 2],
    /// Whether the plant file determines the parameter.
    pub is_determined_now: bool,
    /// Whether the best excitation would determine it.
    pub is_determined_after: bool,
    /// Other excitation or measurement that would determine it; null if the best excitation does.
    pub determined_by: Option<String>,
}

/// Excitation that the rig can run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeterminingTestSignal {
    /// Name of the excitation.
    pub name: String,
    /// Effect or parameter that it shows.
    pub about: String,
    /// Duration (s).
    pub duration_s: f64,
    /// Highest chamber pressure in the model (bar gauge).
    pub highest_bar: f64,
    /// Names of the parameters that the excitation would determine and the plant file does not.
    pub determines: Vec<String>,
    /// Width of the intervals after the experiment over that now: geometric mean over the parameters that the plant file leaves
    /// undetermined.
    pub width_after: f64,
}

impl DeterminingExperiment {
    /// Returns the JSON Schema of such an experiment.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }

    /// Returns whether all parameters are determined after the best excitation.
    pub fn determines_all(&self) -> bool {
        self.parameters.iter().all(|one| one.is_determined_after)
    }

    /// Returns the best excitation as a log of commands, one row per ECU sample: `time_s,duty_fill_pct,duty_vent_pct`.
    pub fn csv(&self) -> String {
        let end_s = self.ranking.first().map_or(0.0, |best| best.duration_s);
        rows(&self.sequence, end_s, self.sample_time_s)
    }
}
