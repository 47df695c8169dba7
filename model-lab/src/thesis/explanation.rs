//! Explanation of the filling times, as in its JSON.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

/// Schema of [`Explanation`] as JSON.
pub const EXPLANATION_SCHEMA: &str = "retarder.thesis-explanation/1";

/// Result of the search for an explanation of the filling times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Explanation {
    /// Name and version of this format, `retarder.thesis-explanation/1`.
    pub schema: String,
    /// Training figures, validation figures, and the largest error of an explained time.
    pub rule: String,
    /// The plain model first, then the candidates, smallest remaining error first.
    pub rows: Vec<Explained>,
    /// The answer in words.
    pub sentence: String,
}

impl Explanation {
    /// Returns whether some effect explains the times.
    pub fn brings_in(&self) -> bool {
        self.rows.iter().any(|row| row.brings_in)
    }

    /// Returns the JSON Schema of an explanation.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }
}

/// Filling times with some effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Explained {
    /// Ids with the form of the law, `supply_line_droop:line_volume`; none for the plain model.
    pub effects: Vec<String>,
    /// Fitted parameters.
    pub parameters: Vec<ExplainedParameter>,
    /// Every filling time.
    pub figures: Vec<ExplainedFigure>,
    /// Rms error of the training figures, those of the large orifices (samples).
    pub fit_rms_samples: f64,
    /// Rms error of the validation figures, those of the inserted orifices (samples).
    pub check_rms_samples: f64,
    /// Whether every training figure is explained.
    pub brings_in: bool,
}

/// Fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplainedParameter {
    /// `section.key` in a plant file, whose end is the unit.
    pub name: String,
    /// Best value.
    pub value: f64,
    /// Whether it reached the end of its range.
    pub at_bound: bool,
}

/// Filling time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplainedFigure {
    /// Table of the thesis.
    pub source: String,
    /// Name of the rig.
    pub rig: String,
    /// Measured quantity.
    pub quantity: String,
    /// Value as printed (T_req).
    pub measured: f64,
    /// Simulated value (T_req); null where the model never reaches the pressure.
    pub simulated: Option<f64>,
    /// Simulated minus measured (samples).
    pub error_samples: f64,
    /// Whether it is a training figure.
    pub is_fitted: bool,
}
