//! Flow by ISO 6358: a conductance C and a critical ratio b.

use crate::reference_plant::{Gas, Nozzle, Subsonic};

/// Gas constant of air (J/(kg K)) and ratio of its heat capacities.
pub(super) const GAS_CONSTANT: f64 = 287.05;
pub(super) const HEAT_CAPACITY_RATIO: f64 = 1.4;
/// Density (kg/m³) and temperature (K) of the reference atmosphere ANR, to which C refers.
const ANR_DENSITY: f64 = 1.185;
const ANR_TEMPERATURE: f64 = 293.15;
/// One dm³/(s bar) in m³/(s Pa).
const PER_DM3_PER_S_BAR: f64 = 1e-8;

/// Conductance of an opening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductance {
    /// Sonic conductance C (dm³/(s bar) at 1.185 kg/m³ and 20 °C).
    pub dm3_per_s_bar: f64,
    /// Critical ratio b of the pressures, 0 to 1.
    pub critical_ratio: f64,
}

impl Conductance {
    /// Returns the area (m²) of the ideal nozzle with the same choked flow.
    pub fn nozzle_area_m2(&self) -> f64 {
        let choked = self.dm3_per_s_bar * PER_DM3_PER_S_BAR * ANR_DENSITY;
        choked / air(0.5).flow(1.0, (1.0, ANR_TEMPERATURE), (0.0, ANR_TEMPERATURE))
    }
}

/// Opening that gas flows through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Orifice {
    nozzle: Nozzle,
    area_m2: f64,
}

impl Orifice {
    pub(super) fn new(conductance: &Conductance) -> Self {
        Self {
            nozzle: air(conductance.critical_ratio),
            area_m2: conductance.nozzle_area_m2(),
        }
    }

    /// Returns the mass flow (kg/s) from the first to the second place, each (Pa abs, K), through this share of the
    /// opening; negative if the second pressure is higher.
    pub(super) fn flow(&self, share: f64, from: (f64, f64), to: (f64, f64)) -> f64 {
        self.nozzle.flow(share * self.area_m2, from, to)
    }
}

fn air(critical_ratio: f64) -> Nozzle {
    let gas = Gas {
        gas_constant_j_per_kg_k: GAS_CONSTANT,
        heat_capacity_ratio: HEAT_CAPACITY_RATIO,
        // The nozzle uses only the two values above.
        temperature_k: ANR_TEMPERATURE,
        supply_pressure_bar_gauge: 0.0,
        ambient_pressure_pa: 0.0,
    };
    let subsonic = Subsonic::Iso6358 {
        critical_ratio,
        index: 0.5,
    };
    Nozzle::new(&gas, subsonic)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: Conductance = Conductance {
        dm3_per_s_bar: 0.6,
        critical_ratio: 0.3,
    };

    #[test]
    fn the_choked_flow_is_that_of_the_standard() {
        let orifice = Orifice::new(&VALVE);
        for (temperature_k, expected) in [
            (293.15, 0.6e-8 * 1.185 * 5e5),
            (350.0, 0.6e-8 * 1.185 * 5e5 * (293.15_f64 / 350.0).sqrt()),
        ] {
            let flow = orifice.flow(1.0, (5e5, temperature_k), (1e5, 293.15));
            assert!((flow / expected - 1.0).abs() < 1e-12, "{flow} {expected}");
        }
    }

    #[test]
    fn the_subsonic_flow_is_an_ellipse_and_changes_its_sign_with_the_direction() {
        let orifice = Orifice::new(&VALVE);
        let flow = |from: f64, to: f64| orifice.flow(0.5, (from, 293.15), (to, 293.15));
        // Half of the way from b to 1.
        let ratio = flow(4e5, 0.65 * 4e5) / flow(4e5, 0.0);
        assert!((ratio - 0.75_f64.sqrt()).abs() < 1e-12, "{ratio}");
        assert_eq!(flow(2e5, 4e5), -flow(4e5, 2e5));
    }
}
