//! What lies between a valve and the pressure beyond it (E51, E56).

use crate::orifice::NozzleLaw;
use crate::restriction::Restriction;

/// A supply line or an outlet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Line {
    /// A narrowest place, and no volume between it and the valve.
    Orifice(Restriction),
    /// A narrowest place, and a volume (m³) between it and the valve.
    Volume(Restriction, f64),
    /// A pressure that gives way in proportion to the flow.
    Yielding {
        /// Pressure per mass flow (Pa s/kg).
        resistance: f64,
        /// Time constant with which the pressure follows the flow (s).
        response: f64,
    },
}

/// bar s/g in Pa s/kg.
const PA_S_PER_KG: f64 = 1e5 / 1e-3;

impl Line {
    /// A yielding line that loses `bar_s_per_g`, none if that is 0, with the time constant `response` (s).
    pub(crate) fn yielding(bar_s_per_g: f64, response: f64) -> Option<Self> {
        (bar_s_per_g != 0.0).then_some(Self::Yielding {
            resistance: bar_s_per_g * PA_S_PER_KG,
            response,
        })
    }

    /// The orifice in a row with the valve, where the line has no pressure of its own.
    pub(crate) fn orifice(self) -> Option<Restriction> {
        match self {
            Self::Orifice(restriction) => Some(restriction),
            Self::Volume(..) | Self::Yielding { .. } => None,
        }
    }

    /// Whether the pressure at the valve is a state.
    pub(crate) fn has_pressure(self) -> bool {
        self.orifice().is_none()
    }

    /// d(pressure)/dt (Pa/s) at the valve, which draws a mass flow `drawn` (kg/s) from the line at `pressure`, where
    /// the pressure `beyond` it is steady (Pa abs); `gas` is R T (J/kg).
    pub(crate) fn pressure_rate(
        self,
        (nozzle, gas): (&NozzleLaw, f64),
        beyond: f64,
        pressure: f64,
        drawn: f64,
    ) -> f64 {
        match self {
            Self::Orifice(_) => 0.0,
            Self::Volume(restriction, volume) => {
                gas / volume * (restriction.mass_flow(nozzle, beyond, pressure) - drawn)
            }
            Self::Yielding {
                resistance,
                response,
            } => (beyond - resistance * drawn - pressure) / response,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlantParameters;

    /// In the end a yielding line has lost its resistance times the flow, whichever way that goes.
    #[test]
    fn a_yielding_line_rests_where_the_flow_leaves_it() {
        let nozzle = PlantParameters::nominal().plant().nozzle;
        let line = Line::Yielding {
            resistance: 2e6,
            response: 0.03,
        };
        let rate = |pressure, drawn| line.pressure_rate((&nozzle, 84e3), 9e5, pressure, drawn);
        assert_eq!(rate(9e5, 0.0), 0.0);
        assert!(rate(9e5 - 4e3, 2e-3).abs() < 1e-6);
        assert!(rate(9e5 + 4e3, -2e-3).abs() < 1e-6);
        // It starts off at the distance over the time constant.
        assert!((rate(9e5, 2e-3) + 4e3 / 0.03).abs() < 1e-6);
    }
}
