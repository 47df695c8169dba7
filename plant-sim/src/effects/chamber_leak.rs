//! Effect: the chamber loses air to the surroundings.

use crate::additions::{Leak, LeakLaw};
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.chamber_leak":
    AREA = area_m2 ["m2"] 1e-11 ..= 1e-5, Log 2e-8, off 0.0,
        "effective area of the orifice that leaks as much at full supply pressure, without a fill valve at 6.3 bar gauge (E41)";
    SHARE = laminar_share [""] 0.0 ..= 1.0, Linear 0.5,
        "share of the laminar part in the pressure loss of the leak at full supply pressure, without a fill valve at 6.3 bar gauge (E41)";
    EXPONENT = exponent [""] 0.3 ..= 3.0, Linear 1.5,
        "exponent of the leak's flow over the gauge pressure (E41)";
}

static ABOUT: About = About {
    id: "chamber_leak",
    sentence: "The chamber or its fittings lose air to the surroundings, so the pressure sinks while both valves are shut.",
    source: "E41: ISO 6358-1 for the orifice, Hagen and Poiseuille for a narrow gap, Forchheimer in between",
    acts_on: EntryPoint::Leak,
    variants: &[
        Variant {
            name: "orifice",
            about: "a hole: choked flow in proportion to the absolute pressure",
            parameters: &[&AREA],
        },
        Variant {
            name: "laminar",
            about: "a long narrow gap: flow as the difference of the squared pressures",
            parameters: &[&AREA],
        },
        Variant {
            name: "mixed",
            about: "a gap with turbulent ends: laminar and quadratic pressure loss in series",
            parameters: &[&AREA, &SHARE],
        },
        Variant {
            name: "power",
            about: "porous walls: a power of the gauge pressure",
            parameters: &[&AREA, &EXPONENT],
        },
    ],
    excited_by: "both valves shut for 5 s at two pressures",
    confused_with: &[
        "supply_seat_leak",
        "gas_temperature",
        "regulating_valve_volume",
        "sensor_offset",
    ],
};

/// The effect.
#[derive(Debug)]
pub struct ChamberLeak;

/// Returns the leak of `setting`, sized at the reference pressure. The setting has the keys and forms of this effect.
pub(super) fn leak(setting: &EffectSetting, parameters: &PlantParameters, plant: &Plant) -> Leak {
    let law = match setting.variant().name {
        "laminar" => LeakLaw::Mixed(1.0),
        "mixed" => LeakLaw::Mixed(setting.value("laminar_share")),
        "power" => LeakLaw::Power(setting.value("exponent")),
        _ => LeakLaw::Orifice,
    };
    Leak::new(
        law,
        setting.value("area_m2"),
        &plant.nozzle,
        parameters.reference_pressure_pa(),
        plant.ambient_pressure,
    )
}

impl Effect for ChamberLeak {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        plant.additions.leaks[0] = Some(leak(setting, parameters, plant));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::PA_PER_BAR;
    use crate::{Simulator, Tolerance};

    fn leak(variant: &str, key: Option<(&str, f64)>) -> (Leak, Plant) {
        let nominal = PlantParameters::nominal();
        let plant = nominal.plant();
        let variant = ABOUT.variant(variant).unwrap();
        let mut setting = EffectSetting::typical_variant(&ChamberLeak, variant);
        if let Some((key, value)) = key {
            setting = setting.with(key, value);
        }
        (super::leak(&setting, &nominal, &plant), plant)
    }

    /// Without a pressure difference an orifice has no flow, and a law sized by it once gave 0/0: the simulation never
    /// ended.
    #[test]
    fn a_leak_has_its_size_while_the_supply_is_shut_off() {
        for variant in ABOUT.variants {
            let mut parameters = PlantParameters::nominal();
            parameters.gas.supply_pressure_bar_gauge = 0.0;
            let plant = parameters.plant();
            let setting = EffectSetting::typical_variant(&ChamberLeak, variant);
            let leak = super::leak(&setting, &parameters, &plant);
            let ambient = plant.ambient_pressure;
            assert_eq!(leak.mass_flow(&plant.nozzle, ambient, ambient), 0.0);
            let expected = plant.nozzle.mass_flow(2e-8, ambient + PA_PER_BAR, ambient);
            let found = leak.mass_flow(&plant.nozzle, ambient + PA_PER_BAR, ambient);
            assert!((found / expected - 1.0).abs() < 1e-12, "{}", variant.name);
        }
    }

    /// A tank has no supply: its leak was once sized at an undefined pressure, and at another one after the file was
    /// read again.
    #[test]
    fn a_leak_without_a_fill_valve_is_sized_at_a_stated_pressure() {
        for variant in ABOUT.variants {
            let mut tank = PlantParameters::nominal();
            tank.functions[0] = crate::valve::ValveFunction::Absent;
            tank.effects = vec![EffectSetting::typical_variant(&ChamberLeak, variant)];
            let read = PlantParameters::from_toml(&tank.to_toml(), "tank.toml").unwrap();
            for parameters in [&tank, &read] {
                let plant = parameters.plant();
                let leak = super::leak(&parameters.effects[0], parameters, &plant);
                let ambient = plant.ambient_pressure;
                let high = ambient + 6.3 * PA_PER_BAR;
                let expected = plant.nozzle.mass_flow(2e-8, high, ambient);
                let flow = leak.mass_flow(&plant.nozzle, high, ambient);
                assert!((flow / expected - 1.0).abs() < 1e-12, "{}", variant.name);
            }
        }
    }

    #[test]
    fn every_law_leaks_as_much_as_the_orifice_at_the_supply_pressure() {
        for variant in ABOUT.variants {
            let (leak, plant) = leak(variant.name, None);
            let (high, low) = (plant.supply_pressure, plant.ambient_pressure);
            let expected = plant.nozzle.mass_flow(2e-8, high, low);
            let flow = leak.mass_flow(&plant.nozzle, high, low);
            assert!((flow / expected - 1.0).abs() < 1e-12, "{}", variant.name);
            assert_eq!(leak.mass_flow(&plant.nozzle, low, high), -flow);
            assert_eq!(leak.mass_flow(&plant.nozzle, low, low), 0.0);
        }
    }

    /// A long narrow gap: half the difference of squares gives half the flow. A short one: its square root.
    #[test]
    fn the_mixed_law_goes_from_poiseuille_to_the_square_root() {
        let low = 101_325.0_f64;
        for (share, exponent) in [(1.0, 1.0), (0.0, 0.5)] {
            let (leak, plant) = leak("mixed", Some(("laminar_share", share)));
            let flow =
                |square: f64| leak.mass_flow(&plant.nozzle, (low * low + square).sqrt(), low);
            let ratio = flow(4e11) / flow(2e11);
            assert!(
                (ratio - 2.0_f64.powf(exponent)).abs() < 1e-9,
                "{share}: {ratio}"
            );
        }
    }

    /// Both valves shut. Choked orifice: p = p_0 exp(-λ t). Gap: dp/dt = -κ (p² - a²), so p = a coth(κ a t + c).
    #[test]
    fn a_shut_chamber_leaks_down_in_closed_form() {
        let (start, low) = (8e5, 101_325.0_f64);
        let after_two_seconds = |variant: &str| {
            let setting =
                EffectSetting::typical_variant(&ChamberLeak, ABOUT.variant(variant).unwrap());
            let plant = PlantParameters::nominal().with_effect(setting);
            let mut simulator = Simulator::with_tolerance(&plant, Tolerance::scaled(0.01));
            simulator.set_chamber_pressure(start);
            simulator.advance_to_ns(2_000_000_000);
            simulator.state().pressure
        };
        let (leak, plant) = leak("laminar", None);
        let per_mass = plant.chamber.pressure_per_mass;

        let rate = per_mass * plant.nozzle.choked_factor() * 2e-8;
        let expected = start * (-2.0 * rate).exp();
        let found = after_two_seconds("orifice");
        assert!((found - expected).abs() < 1.0, "{found} {expected}");

        let kappa =
            per_mass * leak.mass_flow(&plant.nozzle, start, low) / (start * start - low * low);
        let c = 0.5 * ((start + low) / (start - low)).ln();
        let expected = low / (kappa * low * 2.0 + c).tanh();
        let found = after_two_seconds("laminar");
        assert!((found - expected).abs() < 1.0, "{found} {expected}");
    }
}
