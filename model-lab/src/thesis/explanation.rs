//! What an explanation of the filling times says, as it stands in its JSON.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

/// Schema of [`Explanation`] as JSON.
pub const EXPLANATION_SCHEMA: &str = "retarder.thesis-explanation/1";

/// How each suspect explains the filling times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Explanation {
    /// [`EXPLANATION_SCHEMA`].
    pub schema: String,
    /// What was fitted, what judges, and when a time counts as brought in.
    pub rule: String,
    /// The plain model first, then the candidates, the one that leaves least first.
    pub rows: Vec<Explained>,
    /// The answer in words.
    pub sentence: String,
}

impl Explanation {
    /// Whether some effect brings the times in.
    pub fn brings_in(&self) -> bool {
        self.rows.iter().any(|row| row.brings_in)
    }

    /// The JSON Schema of an explanation.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }
}

/// The filling times with some effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Explained {
    /// Ids with the form of the law, `supply_line_droop:line_volume`; none for the plain model.
    pub effects: Vec<String>,
    /// What was fitted.
    pub parameters: Vec<ExplainedParameter>,
    /// Every filling time.
    pub figures: Vec<ExplainedFigure>,
    /// Rms error of the fitted figures, those of the large orifices (samples).
    pub fit_rms_samples: f64,
    /// Rms error of the others, those of the inserted orifices (samples).
    pub check_rms_samples: f64,
    /// Whether every fitted figure is brought in.
    pub brings_in: bool,
}

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplainedParameter {
    /// `section.key` in a plant file, whose end is the unit.
    pub name: String,
    /// Best value.
    pub value: f64,
    /// Whether it ran to the end of its range.
    pub at_bound: bool,
}

/// A filling time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplainedFigure {
    /// Table of the thesis.
    pub source: String,
    /// The rig.
    pub rig: String,
    /// What was measured.
    pub quantity: String,
    /// As printed (T_req).
    pub measured: f64,
    /// By the model (T_req); null where the model never gets there.
    pub simulated: Option<f64>,
    /// Simulated minus measured (samples).
    pub error_samples: f64,
    /// Whether it was fitted.
    pub is_fitted: bool,
}
