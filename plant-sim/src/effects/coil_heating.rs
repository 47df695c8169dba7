//! Effect: the coils warm up under current.

use super::coil_ambient_temperature::surroundings;
use crate::additions::HeatStore;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.coil_heating":
    CAPACITY = heat_capacity_j_per_k ["J/K"] 0.5 ..= 5000.0, Log 25.0, off f64::INFINITY,
        "heat capacity of one coil with what warms up along with it (E43)";
    COOLING = cooling_w_per_k ["W/K"] 1e-4 ..= 10.0, Log 0.1,
        "heat that a coil gives to its surroundings per kelvin (E43)";
    WINDING = winding_heat_capacity_j_per_k ["J/K"] 0.1 ..= 1000.0, Log 5.0, off f64::INFINITY,
        "heat capacity of the winding alone (E43)";
    CONDUCTANCE = winding_cooling_w_per_k ["W/K"] 0.01 ..= 100.0, Log 1.0,
        "heat that the winding gives to the body of its valve per kelvin (E43)";
}

static ABOUT: About = About {
    id: "coil_heating",
    sentence: "The current warms the copper, its resistance rises, and after a minute of full duty the same voltage drives several percent less current.",
    source: "E43: thesis, equations 5.2 to 5.7 and figure 5.3, as a heat balance of the coil",
    acts_on: EntryPoint::Coil,
    variants: &[
        Variant {
            name: "adiabatic",
            about: "the heat stays in the coil: right for a minute or two",
            parameters: &[&CAPACITY],
        },
        Variant {
            name: "cooled",
            about: "the coil gives heat to its surroundings and reaches a steady temperature",
            parameters: &[&CAPACITY, &COOLING],
        },
        Variant {
            name: "winding_and_body",
            about: "a quick winding warms the slow body of its valve",
            parameters: &[&CAPACITY, &COOLING, &WINDING, &CONDUCTANCE],
        },
    ],
    excited_by: "20 s or more at high duty, then the same pulses cold and hot",
    confused_with: &["coil_ambient_temperature", "supply_resistance"],
};

/// The effect.
#[derive(Debug)]
pub struct CoilHeating;

impl Effect for CoilHeating {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let whole = HeatStore::new(
            setting.value("heat_capacity_j_per_k"),
            setting.get("cooling_w_per_k").unwrap_or(0.0),
        );
        let winding = setting.get("winding_heat_capacity_j_per_k");
        let winding = winding
            .map(|capacity| HeatStore::new(capacity, setting.value("winding_cooling_w_per_k")));
        let additions = &mut plant.additions;
        let heating = additions.heating.get_or_insert(surroundings(parameters));
        (heating.winding, heating.body) = match winding {
            Some(winding) => (winding, whole),
            None => (whole, None),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    fn after_a_minute_at_full_duty(setting: EffectSetting) -> f64 {
        let plant = PlantParameters::nominal().with_effect(setting);
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        simulator.advance_to_ns(60_000_000_000);
        simulator.sample().current[0]
    }

    /// Figure 5.3: from 292 to 273 mA in 60 s. Without cooling, i(t) solves di/dt = -α e²... in closed form:
    /// R² = R0² + 2 α R0 e² t / C.
    #[test]
    fn the_current_sags_as_in_figure_5_3() {
        let current = after_a_minute_at_full_duty(
            EffectSetting::typical(&CoilHeating).with("heat_capacity_j_per_k", 23.0),
        );
        let resistance =
            (82.2_f64.powi(2) + 2.0 * 0.0039 * 82.2 * 24.0_f64.powi(2) * 60.0 / 23.0).sqrt();
        assert!((current - 24.0 / resistance).abs() < 1e-4, "{current}");
        assert!((0.270..0.276).contains(&current), "{current}");
    }

    /// In the steady state, the heat R i² is dissipated through the surface.
    #[test]
    fn a_cooled_coil_reaches_its_steady_temperature() {
        let variant = ABOUT.variant("cooled").unwrap();
        let setting = EffectSetting::typical_variant(&CoilHeating, variant)
            .with("heat_capacity_j_per_k", 1.0)
            .with("cooling_w_per_k", 0.2);
        let current = after_a_minute_at_full_duty(setting);
        let resistance = 24.0 / current;
        let warming = (resistance / 82.2 - 1.0) / 0.0039;
        assert!(
            (0.2 * warming - 24.0 * current).abs() < 1e-3 * 24.0 * current,
            "{warming} K at {current} A"
        );
    }
}
