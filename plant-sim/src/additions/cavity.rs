//! Second volume behind a tube (E59).

use super::leak::Leak;
use crate::orifice::NozzleLaw;
use crate::restriction::Restriction;

/// Cavity behind a tube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cavity {
    /// Volume (m³).
    pub volume: f64,
    pub(crate) tube: Tube,
    /// Whether the sensor measures the cavity's pressure instead of the chamber's.
    pub(crate) holds_the_sensor: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Tube {
    Orifice(Restriction),
    Laminar(Leak),
}

impl Cavity {
    /// Returns the mass flow from the chamber into the cavity (kg/s).
    pub(crate) fn inflow(&self, nozzle: &NozzleLaw, chamber: f64, cavity: f64) -> f64 {
        match self.tube {
            Tube::Orifice(restriction) => restriction.mass_flow(nozzle, chamber, cavity),
            Tube::Laminar(leak) => leak.mass_flow(nozzle, chamber, cavity),
        }
    }
}
