//! Verdict on a recording, as text and as JSON.

use core::fmt;

use recording::Recording;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check::{Check, CheckId};
use super::plunger::PlungerMotion;
use super::sensor::SensorError;
use super::steps::StepResponse;
use super::valves::Actuations;
use crate::confirmed_fault::ConfirmedFault;
use crate::requirement::{BothValves, Requirement};

/// Name and version of the JSON form of a [`Verdict`].
pub const SCHEMA: &str = "retarder.control/3";

/// All checks of one recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Verdict {
    /// Name and version of this format, `retarder.control/3`.
    pub schema: String,
    /// Source of the recording.
    pub source: String,
    /// Whether every binding check passes, and at least one step was judged.
    pub holds: bool,
    /// Checks with at least one case in the recording.
    pub checks: Vec<Check>,
    /// Checks without a case in the recording: neither passed nor failed.
    pub not_exercised: Vec<CheckId>,
    /// Each judged step of the reference.
    pub steps: Vec<StepResponse>,
    /// Valve actuations; none if they were not logged.
    pub actuations: Option<Actuations>,
    /// Error of the pressure sensor; none if the measured pressure was not recorded.
    pub sensor_error: Option<SensorError>,
    /// Motion of the regulating valve's plunger; none if the plant has none.
    pub plunger: Option<PlungerMotion>,
    /// Faults that the ECU confirmed; none if its state was not recorded, as in a bench log.
    pub confirmed_faults: Option<Vec<ConfirmedFault>>,
}

impl Verdict {
    pub(super) fn new(
        recording: &Recording,
        requirement: &Requirement,
        checks: Vec<Check>,
        steps: Vec<StepResponse>,
        actuations: Option<Actuations>,
        sensor_error: Option<SensorError>,
    ) -> Self {
        let is_exercised = |id: &CheckId| checks.iter().any(|check| check.id == *id);
        let is_required = |id: &CheckId| match id {
            CheckId::NeverBothValves => requirement.both_valves != BothValves::Allowed,
            CheckId::DutyLimits => !requirement.is_pulsed,
            CheckId::Lifts => requirement.lifts_per_s.is_some(),
            _ => true,
        };
        Self {
            schema: SCHEMA.to_owned(),
            source: recording.provenance().source.clone(),
            // A recording without any step is no evidence.
            holds: !steps.is_empty() && checks.iter().all(|check| check.holds || !check.binding),
            not_exercised: CheckId::ALL
                .into_iter()
                .filter(|id| is_required(id) && !is_exercised(id))
                .collect(),
            checks,
            steps,
            actuations,
            sensor_error,
            plunger: None,
            confirmed_faults: None,
        }
    }

    /// Returns the check with this id, if the recording contains a case of it.
    pub fn check(&self, id: CheckId) -> Option<&Check> {
        self.checks.iter().find(|check| check.id == id)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: {}",
            self.source,
            if self.holds { "pass" } else { "FAIL" }
        )?;
        self.checks
            .iter()
            .try_for_each(|check| writeln!(f, "  {check}"))
    }
}
