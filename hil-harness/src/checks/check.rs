//! One requirement with the value that was reached.

use core::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One requirement with the reached value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Identifier of the check.
    pub id: CheckId,
    /// Requirement in words, with its source.
    pub requirement: String,
    /// Comparison of `reached` with `limit`.
    pub bound: Bound,
    /// Limit, in `unit`.
    pub limit: f64,
    /// Worst value, in `unit`; none if it was never reached.
    pub reached: Option<f64>,
    /// Unit of `limit` and `reached`.
    pub unit: String,
    /// Whether `reached` respects `limit`.
    pub holds: bool,
    /// Whether the requirements bind it. A check that is not binding is shown and does not decide the verdict.
    pub binding: bool,
    /// Place of the worst value, or number of evaluated cases.
    pub evidence: String,
}

/// Check, with a stable name for files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the requirement of each check says what it is")]
pub enum CheckId {
    SettlingTime,
    SteadyError,
    Overshoot,
    SettlingTimeBeyondOperatingRange,
    FillTime,
    FillTimeWithDeadTime,
    FillTimeToLevel,
    FillTimeToLevelWithDeadTime,
    VentTime,
    VentTimeWithDeadTime,
    VentTimeToLevel,
    VentTimeToLevelWithDeadTime,
    NeverBothValves,
    DutyLimits,
    RestActuations,
    Lifts,
}

impl CheckId {
    /// All checks, in the order of a verdict.
    pub const ALL: [Self; 16] = [
        Self::SettlingTime,
        Self::SteadyError,
        Self::Overshoot,
        Self::SettlingTimeBeyondOperatingRange,
        Self::FillTime,
        Self::FillTimeWithDeadTime,
        Self::FillTimeToLevel,
        Self::FillTimeToLevelWithDeadTime,
        Self::VentTime,
        Self::VentTimeWithDeadTime,
        Self::VentTimeToLevel,
        Self::VentTimeToLevelWithDeadTime,
        Self::NeverBothValves,
        Self::DutyLimits,
        Self::RestActuations,
        Self::Lifts,
    ];

    /// Returns the name in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SettlingTime => "settling_time",
            Self::SteadyError => "steady_error",
            Self::Overshoot => "overshoot",
            Self::SettlingTimeBeyondOperatingRange => "settling_time_beyond_operating_range",
            Self::FillTime => "fill_time",
            Self::FillTimeWithDeadTime => "fill_time_with_dead_time",
            Self::FillTimeToLevel => "fill_time_to_level",
            Self::FillTimeToLevelWithDeadTime => "fill_time_to_level_with_dead_time",
            Self::VentTime => "vent_time",
            Self::VentTimeWithDeadTime => "vent_time_with_dead_time",
            Self::VentTimeToLevel => "vent_time_to_level",
            Self::VentTimeToLevelWithDeadTime => "vent_time_to_level_with_dead_time",
            Self::NeverBothValves => "never_both_valves",
            Self::DutyLimits => "duty_limits",
            Self::RestActuations => "rest_actuations",
            Self::Lifts => "lifts",
        }
    }
}

/// Comparison of a value with its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The limit itself is allowed.
    AtMost,
    /// The limit itself is not allowed.
    LessThan,
}

impl Bound {
    /// Returns whether `reached` respects `limit`; a missing value does not.
    pub fn allows(self, reached: Option<f64>, limit: f64) -> bool {
        reached.is_some_and(|reached| match self {
            Self::AtMost => reached <= limit,
            Self::LessThan => reached < limit,
        })
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = match (self.holds, self.binding) {
            (true, _) => "pass",
            (false, true) => "FAIL",
            (false, false) => "beyond",
        };
        let relation = match self.bound {
            Bound::AtMost => "at most",
            Bound::LessThan => "less than",
        };
        let reached = self
            .reached
            .map_or("never".to_owned(), |reached| format!("{reached:.2}"));
        write!(
            f,
            "{word:6} {}: {reached}, {relation} {} {} ({})",
            self.id.name(),
            self.limit,
            self.unit,
            self.evidence
        )
    }
}
