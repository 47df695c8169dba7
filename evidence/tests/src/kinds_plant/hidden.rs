//! Effects that a rig hides.

use super::inputs::NOMINAL_V;
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
    /// Current that moves the armatures of the on/off valves. Without it, their delays are those of any pressure.
    pub pull_in: Option<PullIn>,
    /// Area with which the actuator enlarges the first chamber (m²). Without it, the actuator is outside of the chamber.
    pub actuator_area_m2: f64,
    /// Errors of the pressure sensors.
    pub sensor: SensorErrors,
}

/// Current at which the magnet overcomes a spring and the pressure difference at the valve, on which the opening delay depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PullIn {
    /// Its share of the final current, with the supply pressure across the valve (-).
    pub current: f64,
    /// Share of the pressure in the force there (-).
    pub pressure_force: f64,
}

impl PullIn {
    /// Returns the opening delay over that with the supply pressure across the valve at the nominal voltage, at a pressure difference over
    /// the supply pressure and a voltage (V). The force of the magnet grows with the square of the current, which rises exponentially to
    /// its final value.
    pub fn delay(&self, difference: f64, volt: f64) -> f64 {
        let force = 1.0 + self.pressure_force * (difference - 1.0);
        let time = |current: f64| -(1.0 - current.min(0.999)).ln();
        let current = self.current * NOMINAL_V / volt;
        time(current * force.max(0.0).sqrt()) / time(self.current)
    }
}

/// Narrow place of the supply line, and the volume between it and the fill valve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupplyLine {
    /// Narrow place.
    pub restriction: Conductance,
    /// Volume (m³).
    pub volume_m3: f64,
}
