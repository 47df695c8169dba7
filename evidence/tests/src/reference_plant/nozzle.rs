//! Isentropic flow through a nozzle, from first principles (A. H. Shapiro, *The Dynamics and Thermodynamics of
//! Compressible Fluid Flow*, 1953, chapter 4): the gas expands to the throat, where its enthalpy has become velocity.
//! The mass flow is area times density times velocity at the throat, whose velocity never exceeds the speed of sound.

use super::datasheet::Gas;

/// Law of the subsonic flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Subsonic {
    /// Isentropic expansion to the downstream pressure.
    Isentropic,
    /// ISO 6358: (1 - ((r - b)/(1 - b))²)^m with the critical ratio b and the subsonic index m (0.5: an ellipse).
    Iso6358 {
        /// Critical ratio b.
        critical_ratio: f64,
        /// Subsonic index m.
        index: f64,
    },
}

/// Gas, and its law of flow through openings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nozzle {
    /// Gas constant (J/(kg K)).
    gas_constant: f64,
    /// (k - 1)/k.
    exponent: f64,
    /// Heat capacity at constant pressure (J/(kg K)).
    heat_capacity: f64,
    /// Temperature at the sonic throat relative to that upstream, 2/(k + 1).
    sonic_temperature_ratio: f64,
    sonic_pressure_ratio: f64,
    subsonic: Subsonic,
}

impl Nozzle {
    /// Creates the ideal gas of the datasheet.
    pub fn new(gas: &Gas, subsonic: Subsonic) -> Self {
        let k = gas.heat_capacity_ratio;
        let sonic_temperature_ratio = 2.0 / (k + 1.0);
        Self {
            gas_constant: gas.gas_constant_j_per_kg_k,
            exponent: (k - 1.0) / k,
            heat_capacity: gas.gas_constant_j_per_kg_k * k / (k - 1.0),
            sonic_temperature_ratio,
            sonic_pressure_ratio: sonic_temperature_ratio.powf(k / (k - 1.0)),
            subsonic,
        }
    }

    /// Returns the mass flow (kg/s) from the first to the second place, each (Pa abs, K), through an effective area
    /// (m²); negative if the second pressure is higher.
    pub fn flow(&self, area: f64, from: (f64, f64), to: (f64, f64)) -> f64 {
        if area <= 0.0 {
            0.0
        } else if from.0 >= to.0 {
            area * self.flux(from.0, from.1, to.0)
        } else {
            -area * self.flux(to.0, to.1, from.0)
        }
    }

    /// Returns the mass flow per area (kg/(s m²)).
    fn flux(&self, upstream: f64, temperature: f64, downstream: f64) -> f64 {
        let ratio = downstream / upstream;
        match self.subsonic {
            Subsonic::Isentropic if ratio > self.sonic_pressure_ratio => {
                self.expanded(upstream, temperature, ratio, ratio.powf(self.exponent))
            }
            Subsonic::Isentropic => self.sonic(upstream, temperature),
            Subsonic::Iso6358 {
                critical_ratio,
                index,
            } => {
                let beyond = ((ratio - critical_ratio) / (1.0 - critical_ratio)).max(0.0);
                self.sonic(upstream, temperature) * (1.0 - beyond * beyond).powf(index)
            }
        }
    }

    fn sonic(&self, upstream: f64, temperature: f64) -> f64 {
        self.expanded(
            upstream,
            temperature,
            self.sonic_pressure_ratio,
            self.sonic_temperature_ratio,
        )
    }

    /// Returns density times velocity at a throat with these ratios of pressure and temperature to those upstream.
    fn expanded(
        &self,
        upstream: f64,
        temperature: f64,
        pressure_ratio: f64,
        temperature_ratio: f64,
    ) -> f64 {
        let density =
            upstream / (self.gas_constant * temperature) * pressure_ratio / temperature_ratio;
        let velocity =
            (2.0 * self.heat_capacity * temperature * (1.0 - temperature_ratio).max(0.0)).sqrt();
        density * velocity
    }
}
