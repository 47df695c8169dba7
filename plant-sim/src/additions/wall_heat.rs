//! Energy balance of the gas with heat from the wall (E52).

use super::Volume;

/// Heat transfer from the wall to the gas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallHeat {
    /// Conductance between gas and wall (W/K); with natural convection, its value at the reference.
    pub conductance: f64,
    /// Gas constant times density (Pa/K) at which natural convection has that conductance; `None` for a constant
    /// conductance.
    pub convection: Option<f64>,
    /// Heat capacity of the wall (J/K) and its loss to the surroundings (W/K); `None` for a constant wall temperature.
    pub wall: Option<(f64, f64)>,
    /// Temperature of the surroundings and of the supply air (K).
    pub surroundings: f64,
    /// Ratio of heat capacities (-).
    pub heat_capacity_ratio: f64,
    /// Gas constant (J/(kg K)).
    pub gas_constant: f64,
}

/// Flows of the energy balance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Balance {
    /// Mass flow in, at the temperature of the supply (kg/s).
    pub(crate) inflow: f64,
    /// Mass flow out, at the temperature of the chamber (kg/s).
    pub(crate) outflow: f64,
    /// Volume of the gas.
    pub(crate) volume: Volume,
}

/// Temperature difference of the reference of natural convection (K).
const REFERENCE_KELVIN: f64 = 30.0;

impl WallHeat {
    /// Returns the heat transfer of another volume, `times` as large, with a wall at the temperature of the surroundings: the area of its
    /// wall grows with the two-thirds power of the volume.
    pub(crate) fn of_volume(&self, times: f64) -> Self {
        Self {
            conductance: self.conductance * times.powf(2.0 / 3.0),
            wall: None,
            ..*self
        }
    }

    /// Returns the conductance between gas and wall (W/K). Turbulent natural convection has Nu ∝ Ra^(1/3), and Ra is
    /// proportional to ρ² ΔT: the size of the chamber cancels.
    pub(crate) fn conductance(&self, pressure: f64, temperature: f64, wall: f64) -> f64 {
        let Some(reference) = self.convection else {
            return self.conductance;
        };
        let dense = pressure / temperature / reference;
        let apart = (wall - temperature).abs() / REFERENCE_KELVIN;
        self.conductance * (dense * dense * apart).cbrt()
    }

    /// Returns the power that changes the pressure (W): the enthalpy of mass flows in and out (kg/s), and the wall's
    /// heat, times k - 1.
    pub(crate) fn pressure_power(
        &self,
        [inflow, outflow]: [f64; 2],
        pressure: f64,
        temperature: f64,
        wall: f64,
    ) -> f64 {
        let (k, r) = (self.heat_capacity_ratio, self.gas_constant);
        let heat = self.conductance(pressure, temperature, wall) * (wall - temperature);
        k * r * (inflow * self.surroundings - outflow * temperature) + (k - 1.0) * heat
    }

    /// Returns d(pressure)/dt (Pa/s), d(gas temperature)/dt and d(wall temperature)/dt (K/s) at a [pressure
    /// power](Self::pressure_power).
    pub(crate) fn rates(
        &self,
        balance: &Balance,
        pressure_power: f64,
        pressure: f64,
        temperature: f64,
        wall: f64,
    ) -> [f64; 3] {
        let Balance {
            inflow,
            outflow,
            volume,
        } = *balance;
        let (k, r) = (self.heat_capacity_ratio, self.gas_constant);
        let pressure_rate = (pressure_power - k * pressure * volume.growth)
            / (volume.size + k * pressure * volume.compliance);
        let mass = pressure * volume.size / (r * temperature);
        let growth = volume.compliance * pressure_rate + volume.growth;
        let temperature_rate = temperature
            * (pressure_rate / pressure + growth / volume.size - (inflow - outflow) / mass);
        let wall_rate = self.wall.map_or(0.0, |(capacity, loss)| {
            let heat = self.conductance(pressure, temperature, wall) * (wall - temperature);
            (-heat - loss * (wall - self.surroundings)) / capacity
        });
        [pressure_rate, temperature_rate, wall_rate]
    }
}
