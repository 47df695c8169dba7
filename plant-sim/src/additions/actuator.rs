//! Actuator that enlarges the chamber as it moves (E74).

use super::Volume;

/// Actuator whose motion is imposed from outside: its logged position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Area (m²): the volume over the position. Negative if the chamber shrinks as the position grows.
    pub area: f64,
    /// Present velocity (m/s).
    pub velocity: f64,
}

impl Actuator {
    /// Returns the volume at `position` (m) beyond that of the chamber at position 0, `chamber` (m³). A chamber without
    /// volume has no pressure: the simulation is aborted.
    pub(crate) fn volume(&self, position: f64, chamber: f64) -> Volume {
        let size = self.area * position;
        Volume {
            size: if chamber + size > 0.0 { size } else { f64::NAN },
            compliance: 0.0,
            growth: self.area * self.velocity,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::{EffectSetting, by_id};
    use crate::{PlantParameters, Simulator, Tolerance};

    const AREA: f64 = 1e-3;
    const START_PA: f64 = 4e5;

    /// Returns the pressure (Pa abs) of a closed chamber of 75 cm³ after the actuator has moved by 20 mm in 0.1 s, and 1 s later.
    fn moved(plant: &PlantParameters) -> [f64; 2] {
        let setting = EffectSetting::typical(by_id("actuator_volume").unwrap());
        let plant = plant.with_effect(setting.with("area_m2", AREA));
        let mut simulator = Simulator::with_tolerance(&plant, Tolerance::scaled(0.01));
        simulator.set_chamber_pressure(START_PA);
        simulator.move_actuator(0.01, 0.0);
        simulator.move_actuator(0.03, 0.1);
        simulator.advance_to_ns(100_000_000);
        let moved = simulator.state().pressure;
        simulator.move_actuator(0.03, 0.0);
        simulator.advance_to_ns(1_100_000_000);
        [moved, simulator.state().pressure]
    }

    /// Boyle: the volume grows from V + 10 cm³ to V + 30 cm³.
    #[test]
    fn the_pressure_of_a_closed_chamber_falls_with_its_volume() {
        let [moved, held] = moved(&PlantParameters::nominal());
        let expected = START_PA * (75.0 + 10.0) / (75.0 + 30.0);
        assert!((moved / expected - 1.0).abs() < 1e-5, "{moved} {expected}");
        assert_eq!(moved, held);
    }

    /// Poisson: without heat from the wall, p V^k stays the same.
    #[test]
    fn a_closed_chamber_without_heat_expands_adiabatically() {
        let gas = EffectSetting::typical(by_id("gas_temperature").unwrap());
        let [moved, _] = moved(
            &PlantParameters::nominal().with_effect(gas.with("wall_heat_transfer_w_per_k", 1e-6)),
        );
        let expected = START_PA * f64::powf((75.0 + 10.0) / (75.0 + 30.0), 1.4);
        assert!((moved / expected - 1.0).abs() < 1e-3, "{moved} {expected}");
    }
}
