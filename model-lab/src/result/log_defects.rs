//! Defects of a log in a result.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Defects of a log: pauses, cells without a value, and restarts of the model.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogDefects {
    /// Times at which the commands are unknown, in order; excluded from every error.
    pub gaps: Vec<LogGap>,
    /// Signals with missing cells; these are excluded from every error.
    pub missing: Vec<MissingCells>,
    /// The same value for longer than the noise lets it stay; these readings are excluded from every error, except the first one.
    #[serde(default)]
    pub repeats: Vec<LogRepeat>,
    /// Readings that stand out alone; these are excluded from every error.
    #[serde(default)]
    pub spikes: Vec<LogSpike>,
    /// The defects in words, one sentence without a full stop for each.
    pub sentences: Vec<String>,
}

/// Time for which the commands are unknown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogGap {
    /// Last instant before the gap (s), in the time of the log.
    pub start_s: f64,
    /// First instant after the gap (s).
    pub end_s: f64,
    /// Samples within and after the gap that are excluded from every error: commands need a delay, a PWM period and 50 ms to be in force.
    pub samples: usize,
    /// Pressure at which the model restarted after the gap (bar gauge); null where none was measured.
    pub restart_bar_gauge: Option<f64>,
}

/// Reading that repeats: its converter is at its end, or the logger got no new value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogRepeat {
    /// Name of the signal.
    pub signal: String,
    /// Unit of the value.
    pub unit: String,
    /// Time of its first sample since the start of the log (s).
    pub time_s: f64,
    /// Time from there to its last sample (s).
    pub duration_s: f64,
    /// Value.
    pub value: f64,
}

/// Readings that stand out alone from those around them: a spike or a dropout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogSpike {
    /// Name of the signal.
    pub signal: String,
    /// Unit of the height.
    pub unit: String,
    /// Time of its first sample since the start of the log (s).
    pub time_s: f64,
    /// Time from there to its last sample (s); 0 for a single one.
    pub duration_s: f64,
    /// Height over the samples around it.
    pub height: f64,
}

/// Cells of a signal without a value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MissingCells {
    /// Name of the signal.
    pub signal: String,
    /// Number of such cells.
    pub cells: usize,
    /// Number of these cells that contained a value outside the hard bounds of the quantity.
    pub out_of_bounds: u64,
}
