//! Second volume behind a tube (E59).

use super::leak::Leak;
use crate::orifice::NozzleLaw;
use crate::restriction::Mouth;

/// Cavity behind a tube.
#[derive(Debug, Clone, PartialEq)]
pub struct Cavity {
    /// Volume (m³).
    pub volume: f64,
    pub(crate) tube: Tube,
    /// Whether the sensor measures the cavity's pressure instead of the chamber's.
    pub(crate) holds_the_sensor: bool,
    /// Whether a leak is in the cavity instead of the chamber.
    pub(crate) has_the_leak: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Tube {
    Orifice(Mouth),
    /// Line with a critical ratio of its own.
    Line(Mouth, Box<NozzleLaw>),
    Laminar(Leak),
}

impl Cavity {
    /// Returns whether it is a second chamber, with an energy balance of its own.
    pub(crate) fn is_second_chamber(&self) -> bool {
        matches!(self.tube, Tube::Line(..))
    }

    /// Returns the mass flow from the chamber into the cavity (kg/s).
    pub(crate) fn inflow(&self, nozzle: &NozzleLaw, chamber: f64, cavity: f64) -> f64 {
        match &self.tube {
            Tube::Orifice(mouth) => mouth.mass_flow(nozzle, chamber, cavity),
            Tube::Line(mouth, nozzle) => mouth.mass_flow(nozzle, chamber, cavity),
            Tube::Laminar(leak) => leak.mass_flow(nozzle, chamber, cavity),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::{EffectSetting, by_id};
    use crate::parameters::SensorPlace;
    use crate::{Command, PlantParameters, Simulator, Tolerance};

    /// Returns chamber volume times pressure of both chambers (J), 0.12 s and 3 s after a pulse began that ended after 0.05 s, and their
    /// pressure difference at these times (Pa).
    fn after_a_pulse(heat_transfer_w_per_k: f64) -> [(f64, f64); 2] {
        let mut plant = PlantParameters::nominal();
        plant.second_chamber.volume_m3 = 50e-6;
        plant.second_chamber.conductance_dm3_per_s_bar = 0.02;
        plant.second_chamber.critical_ratio = 0.3;
        let gas = by_id("gas_temperature").unwrap();
        let form = gas.about().variant("constant_wall").unwrap();
        let setting = EffectSetting::typical_variant(gas, form);
        let plant =
            plant.with_effect(setting.with("wall_heat_transfer_w_per_k", heat_transfer_w_per_k));
        let mut simulator = Simulator::with_tolerance(&plant, Tolerance::scaled(0.01));
        let pulse = |duty_fill_pct| Command {
            duty_fill_pct,
            duty_vent_pct: 0.0,
        };
        simulator.command(pulse(100.0));
        simulator.advance_to_ns(50_000_000);
        simulator.command(pulse(0.0));
        [120_000_000, 3_000_000_000].map(|time_ns| {
            simulator.advance_to_ns(time_ns);
            let near = simulator.state().pressure;
            let mut states = simulator.effect_states();
            let far = states.find(|state| state.name == "p_cavity").unwrap().value;
            (near * 75e-6 + far * 50e-6, near - far)
        })
    }

    /// First law: without heat from the walls, the inner energy of the air in both chambers, p V / (k - 1), stays the same while the
    /// pressures equalise.
    #[test]
    fn without_heat_the_energy_of_both_chambers_is_conserved() {
        let [(begin, apart), (end, equal)] = after_a_pulse(1e-4);
        assert!(apart > 1e5 && equal.abs() < 100.0, "{apart} {equal}");
        assert!((end / begin - 1.0).abs() < 1e-3, "{begin} {end}");
    }

    /// With walls that hold the temperature, the mass is conserved: p V / (R T).
    #[test]
    fn with_much_heat_the_mass_in_both_chambers_is_conserved() {
        let [(begin, _), (end, equal)] = after_a_pulse(100.0);
        assert!(equal.abs() < 100.0, "{equal}");
        assert!((end / begin - 1.0).abs() < 2e-3, "{begin} {end}");
    }

    /// Behind a thin line, the second chamber follows later; the sensor shows the chamber that it is in.
    #[test]
    fn the_sensor_shows_the_chamber_that_it_is_in() {
        let shown = |sensor: SensorPlace| {
            let mut plant = PlantParameters::nominal();
            plant.second_chamber.volume_m3 = 50e-6;
            plant.second_chamber.conductance_dm3_per_s_bar = 0.02;
            plant.second_chamber.critical_ratio = 0.3;
            plant.second_chamber.sensor = sensor;
            let mut simulator = Simulator::new(&plant);
            simulator.command(Command {
                duty_fill_pct: 100.0,
                duty_vent_pct: 0.0,
            });
            simulator.advance_to_ns(80_000_000);
            simulator.sample()
        };
        let [first, second] = [SensorPlace::Chamber, SensorPlace::SecondChamber].map(shown);
        assert_eq!(first.pressure, second.pressure);
        assert_eq!(first.measured_pressure, first.pressure);
        assert_eq!(first.pressure_at_sensor, first.pressure);
        assert_eq!(second.measured_pressure, second.pressure_at_sensor);
        assert!(second.measured_pressure < 0.7 * first.pressure);
    }
}
