//! Faults that the ECU confirmed in a run.

use ecu::{Fault, FaultSet};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::wire::Exchange;

/// Fault that the ECU confirmed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConfirmedFault {
    /// Name of the fault, as in docs/safety.md.
    pub fault: String,
    /// Instant of its first confirmation (s); negative in the lead-in before time 0.
    pub first_s: f64,
    /// Number of samples in which it was confirmed.
    pub samples: u32,
}

/// Returns the faults in the telemetry of `exchanges`, in the order of their first confirmation. Time 0 is sample
/// `lead_in`.
pub(crate) fn confirmed(
    exchanges: &[Exchange],
    lead_in: usize,
    sample_s: f64,
) -> Vec<ConfirmedFault> {
    let of = |exchange: &Exchange| FaultSet::from_bits(exchange.answer.telemetry.faults);
    let confirmed = |fault: Fault| {
        let first = exchanges
            .iter()
            .position(|exchange| of(exchange).contains(fault))?;
        let samples = exchanges
            .iter()
            .filter(|exchange| of(exchange).contains(fault));
        Some(ConfirmedFault {
            fault: format!("{fault:?}"),
            first_s: (first as f64 - lead_in as f64) * sample_s,
            samples: samples.count() as u32,
        })
    };
    if exchanges.iter().all(|exchange| of(exchange).is_empty()) {
        return Vec::new();
    }
    let mut faults: Vec<ConfirmedFault> = Fault::ALL.into_iter().filter_map(confirmed).collect();
    faults.sort_by(|one, other| one.first_s.total_cmp(&other.first_s));
    faults
}
