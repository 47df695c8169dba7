//! Chamber (equations 3.17, 3.18, 3.23, 3.24): constant volume, isothermal gas.

/// Chamber parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Chamber {
    /// R T / V (Pa/kg): pressure per mass (equation 3.17).
    pub pressure_per_mass: f64,
    /// V (m³).
    pub volume: f64,
}

impl Chamber {
    /// Creates a chamber of `volume` (m³) with gas of `gas_constant` (J/(kg K)) at `temperature` (K).
    pub fn new(volume: f64, gas_constant: f64, temperature: f64) -> Self {
        Self {
            pressure_per_mass: gas_constant * temperature / volume,
            volume,
        }
    }

    /// Returns dp/dt (Pa/s) for the mass flows in and out (kg/s) (equation 3.24).
    #[inline]
    pub fn pressure_rate(&self, mass_flow_in: f64, mass_flow_out: f64) -> f64 {
        self.pressure_per_mass * (mass_flow_in - mass_flow_out)
    }
}
