//! Lines between a valve and the pressure beyond it (E51, E56).

use crate::orifice::NozzleLaw;
use crate::restriction::{Mouth, Restriction};

/// Supply line or outlet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Line {
    /// Restriction without a volume between it and the valve.
    Orifice(Restriction),
    /// Restriction with a volume (m³) between it and the valve.
    Volume(Mouth, f64),
    /// Pressure that drops in proportion to the flow.
    Yielding {
        /// Pressure per mass flow (Pa s/kg).
        resistance: f64,
        /// Time constant with which the pressure follows the flow (s).
        response: f64,
    },
}

/// Conversion of bar s/g into Pa s/kg.
const PA_S_PER_KG: f64 = 1e5 / 1e-3;

impl Line {
    /// Creates a line that loses `bar_s_per_g`, with the time constant `response` (s); `None` if the loss is 0.
    pub(crate) fn yielding(bar_s_per_g: f64, response: f64) -> Option<Self> {
        (bar_s_per_g != 0.0).then_some(Self::Yielding {
            resistance: bar_s_per_g * PA_S_PER_KG,
            response,
        })
    }

    /// Returns the orifice in series with the valve, if the line has no pressure of its own.
    pub(crate) fn orifice(self) -> Option<Restriction> {
        match self {
            Self::Orifice(restriction) => Some(restriction),
            Self::Volume(..) | Self::Yielding { .. } => None,
        }
    }

    /// Returns whether the pressure at the valve is a state.
    pub(crate) fn has_pressure(self) -> bool {
        self.orifice().is_none()
    }

    /// Returns d(pressure)/dt (Pa/s) at the valve, which draws a mass flow `drawn` (kg/s) from the line at `pressure`.
    /// The pressure `beyond` the line is constant (Pa abs); `gas` is R T (J/kg).
    pub(crate) fn pressure_rate(
        self,
        (nozzle, gas): (&NozzleLaw, f64),
        beyond: f64,
        pressure: f64,
        drawn: f64,
    ) -> f64 {
        match self {
            Self::Orifice(_) => 0.0,
            Self::Volume(mouth, volume) => {
                gas / volume * (mouth.mass_flow(nozzle, beyond, pressure) - drawn)
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

    /// In the steady state, the pressure drop of a yielding line is its resistance times the flow, in either direction.
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
        // The initial rate is the distance divided by the time constant.
        assert!((rate(9e5, 2e-3) + 4e3 / 0.03).abs() < 1e-6);
    }
}
