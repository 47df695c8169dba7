//! Effect: the gas warms on filling and cools on venting.

use crate::additions::WallHeat;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.gas_temperature":
    CONDUCTANCE = wall_heat_transfer_w_per_k ["W/K"] 1e-4 ..= 1000.0, Log 0.1, off f64::INFINITY,
        "heat between gas and wall per kelvin (E52); infinite keeps the gas at its temperature, as the plain model does";
    CONVECTION = convection_w_per_k ["W/K"] 1e-4 ..= 1000.0, Log 0.3, off f64::INFINITY,
        "heat between gas and wall per kelvin at full supply pressure, without a fill valve at 6.3 bar gauge, and 30 K difference (E52)";
    CAPACITY = wall_heat_capacity_j_per_k ["J/K"] 1e-3 ..= 1e4, Log 5.0,
        "heat capacity of the layer of the wall that follows the gas (E52)";
    LOSS = wall_loss_w_per_k ["W/K"] 1e-4 ..= 100.0, Log 0.5,
        "heat between that layer and the surroundings per kelvin (E52)";
}

static ABOUT: About = About {
    id: "gas_temperature",
    sentence: "Air gets warm when the chamber is filled and cold when it is vented; afterwards the pressure creeps back as the wall takes the temperature out.",
    source: "E52: energy balance of an ideal gas with heat transfer to the wall; Carneiro and Almeida, Proc. IMechE I 221 (2007), for its use in pneumatics",
    acts_on: EntryPoint::GasEnergy,
    variants: &[
        Variant {
            name: "constant_wall",
            about: "the wall stays at the temperature of the plant file: one time constant",
            parameters: &[&CONDUCTANCE],
        },
        Variant {
            name: "warming_wall",
            about: "the inner wall follows the gas and gives its heat on: two time constants",
            parameters: &[&CONDUCTANCE, &CAPACITY, &LOSS],
        },
        Variant {
            name: "convection",
            about: "the gas rises along the wall by itself: more heat while it is dense and its temperature far from the wall's",
            parameters: &[&CONVECTION],
        },
        Variant {
            name: "convection_to_warming_wall",
            about: "natural convection to an inner wall that follows the gas and gives its heat on",
            parameters: &[&CONVECTION, &CAPACITY, &LOSS],
        },
    ],
    excited_by: "fast filling to high pressure, then both valves shut for 3 s; the same slowly",
    confused_with: &[
        "dead_volume",
        "chamber_leak",
        "sensor_lag",
        "regulating_valve_volume",
    ],
};

/// The effect.
#[derive(Debug)]
pub struct GasTemperature;

impl Effect for GasTemperature {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let capacity = setting.get("wall_heat_capacity_j_per_k");
        plant.additions.wall_heat = Some(WallHeat {
            conductance: setting
                .get("convection_w_per_k")
                .unwrap_or_else(|| setting.value("wall_heat_transfer_w_per_k")),
            convection: setting
                .get("convection_w_per_k")
                .map(|_| parameters.reference_pressure_pa() / parameters.gas.temperature_k),
            wall: capacity.zip(setting.get("wall_loss_w_per_k")),
            surroundings: parameters.gas.temperature_k,
            heat_capacity_ratio: parameters.gas.heat_capacity_ratio,
            gas_constant: parameters.gas.gas_constant_j_per_kg_k,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator, Tolerance};

    fn simulator(conductance: f64, variant: usize) -> Simulator {
        let variant = &ABOUT.variants[variant];
        let setting = EffectSetting::typical_variant(&GasTemperature, variant)
            .with(variant.parameters[0].key, conductance);
        let plant = PlantParameters::nominal().with_effect(setting);
        Simulator::with_tolerance(&plant, Tolerance::scaled(0.01))
    }

    fn state(simulator: &Simulator, name: &str) -> f64 {
        let mut states = simulator.effect_states();
        states.find(|state| state.name == name).unwrap().value
    }

    /// Hardly any heat transfer: venting follows T ∝ p^((k-1)/k).
    #[test]
    fn fast_venting_is_isentropic() {
        let mut simulator = simulator(1e-4, 0);
        simulator.set_chamber_pressure(9e5);
        simulator.command(Command {
            duty_fill_pct: 0.0,
            duty_vent_pct: 100.0,
        });
        simulator.advance_to_ns(120_000_000);
        let pressure = simulator.state().pressure;
        assert!(pressure < 5e5, "{pressure}");
        let expected = 293.15 * (pressure / 9e5).powf(0.4 / 1.4);
        let temperature = state(&simulator, "t_gas");
        assert!(
            (temperature - expected).abs() < 0.05,
            "{temperature} {expected}"
        );
    }

    /// Shut chamber: the temperature decays to the wall's with m c_v / conductance; at constant volume p ∝ T.
    #[test]
    fn a_shut_chamber_cools_with_one_time_constant() {
        let mut simulator = simulator(0.1, 0);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        simulator.advance_to_ns(100_000_000);
        simulator.command(Command::default());
        simulator.advance_to_ns(200_000_000);
        let (p0, t0) = (simulator.state().pressure, state(&simulator, "t_gas"));
        assert!(t0 > 330.0, "{t0}");
        simulator.advance_to_ns(1_200_000_000);
        let (p1, t1) = (simulator.state().pressure, state(&simulator, "t_gas"));
        let mass = p0 * 75e-6 / (287.05 * t0);
        let rate = 0.1 / (mass * 287.05 / 0.4);
        let expected = 293.15 + (t0 - 293.15) * (-rate).exp();
        assert!((t1 - expected).abs() < 0.01, "{t1} {expected}");
        assert!((p1 / p0 * t0 / t1 - 1.0).abs() < 1e-6);
    }

    /// Nu ∝ Ra^(1/3): an eighth of the density and the same difference give a quarter of the heat.
    #[test]
    fn natural_convection_grows_with_density_and_difference() {
        let variant = ABOUT.variant("convection").unwrap();
        let setting = EffectSetting::typical_variant(&GasTemperature, variant);
        let nominal = PlantParameters::nominal();
        let plant = nominal.with_effect(setting).plant();
        let heat = plant.additions.wall_heat.unwrap();
        let full = plant.supply_pressure;
        let conductance = |pressure: f64, kelvin: f64| {
            // At the density of `pressure` and the temperature of the plant file.
            let temperature = nominal.gas.temperature_k;
            heat.conductance(pressure, temperature, temperature + kelvin)
        };
        assert!((conductance(full, 30.0) - 0.3).abs() < 1e-12);
        assert!((conductance(full / 8.0, 30.0) - 0.3 / 4.0).abs() < 1e-12);
        assert!((conductance(full, -240.0) - 0.3 * 2.0).abs() < 1e-12);
        assert_eq!(conductance(full, 0.0), 0.0);
    }

    /// Heat lost by the gas equals the heat of wall and surroundings: a wall of small heat capacity keeps the gas warm.
    #[test]
    fn a_wall_that_warms_up_holds_the_gas_warm_for_longer() {
        let temperature = |variant| {
            let mut simulator = simulator(1.0, variant);
            simulator.command(Command {
                duty_fill_pct: 100.0,
                duty_vent_pct: 0.0,
            });
            simulator.advance_to_ns(2_000_000_000);
            state(&simulator, "t_gas")
        };
        let [constant, warming, convection, to_warming] = core::array::from_fn(temperature);
        assert!(warming > constant + 0.5);
        assert!(to_warming > convection + 0.5);
    }
}
