//! Effects that a rig hides.

use super::orifice::Conductance;
use super::sensor::SensorErrors;

/// Effects beyond the plain plant; by default none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HiddenEffects {
    /// Leak from the chamber at the far end to the surroundings.
    pub leak: Option<Conductance>,
    /// Heat transfer between the gas of each chamber and its wall (W/K). Without it, the gas keeps its temperature.
    pub heat_w_per_k: Option<[f64; 2]>,
    /// Line before the fill valve.
    pub supply_line: Option<SupplyLine>,
    /// Errors of the pressure sensors.
    pub sensor: SensorErrors,
}

/// Narrow place of the supply line, and the volume between it and the fill valve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupplyLine {
    /// Narrow place.
    pub restriction: Conductance,
    /// Volume (m³).
    pub volume_m3: f64,
}
