//! Effect: the coils are not at 20 °C, and their temperature may change.

use crate::additions::{Heating, WarmUp, resistance};
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.coil_ambient_temperature":
    DIFFERENCE = difference_k ["K"] -70.0 ..= 130.0, Linear 30.0, off 0.0,
        "what the surroundings of the coils are warmer than 20 degC at the beginning (E42)";
    RISE = rise_k ["K"] -100.0 ..= 150.0, Linear 10.0, off 0.0,
        "what the surroundings of the coils warm up further (E42)";
    WARM_UP = warm_up_s ["s"] 1.0 ..= 3600.0, Log 30.0,
        "time constant of their warming, counted from the beginning of a log (E42)";
}

static ABOUT: About = About {
    id: "coil_ambient_temperature",
    sentence: "The valves are hotter or colder than on the bench, so the copper takes less or more current from the same battery.",
    source: "E42: thesis, equation 5.7",
    acts_on: EntryPoint::Coil,
    variants: &[
        Variant {
            name: "uniform",
            about: "both coils alike, from the beginning",
            parameters: &[&DIFFERENCE],
        },
        Variant {
            name: "warming",
            about: "both coils alike, in surroundings that warm up or cool down",
            parameters: &[&DIFFERENCE, &RISE, &WARM_UP],
        },
    ],
    excited_by: "100 % duty until the current is steady, right after a cold start",
    confused_with: &["coil_heating", "supply_resistance"],
};

/// The effect.
#[derive(Debug)]
pub struct CoilAmbientTemperature;

impl Effect for CoilAmbientTemperature {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let coefficient = parameters.coil.resistance_temperature_coefficient_per_k;
        for valve in &mut plant.valves {
            let coil = &mut valve.coil;
            coil.resistance =
                resistance(coil.resistance, coefficient, setting.value("difference_k"));
        }
        if let Some(rise) = setting.get("rise_k") {
            let additions = &mut plant.additions;
            let heating = additions.heating.get_or_insert(surroundings(parameters));
            heating.warm_up = Some(WarmUp {
                in_the_end: rise,
                time_constant: setting.value("warm_up_s"),
            });
        }
    }
}

/// Returns coils with the temperature of their surroundings, which is constant.
pub(super) fn surroundings(parameters: &PlantParameters) -> Heating {
    Heating {
        coefficient: parameters.coil.resistance_temperature_coefficient_per_k,
        at_20: parameters.coil.resistance_20c_ohm,
        ambient: parameters
            .effect("coil_ambient_temperature")
            .map_or(0.0, |effect| effect.value("difference_k")),
        warm_up: None,
        winding: None,
        body: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::steady_current;
    use crate::{Command, Simulator};

    /// 80 K make the resistance of copper a third larger: 24 V / (82.2 Ω · 1.312).
    #[test]
    fn a_hot_coil_takes_the_current_of_equation_5_7() {
        let hot = EffectSetting::typical(&CoilAmbientTemperature).with("difference_k", 80.0);
        let plant = PlantParameters::nominal().with_effect(hot);
        let [mean, ..] = steady_current(&plant, 100.0);
        assert!((mean - 24.0 / (82.2 * 1.312)).abs() < 1e-9, "{mean}");
    }

    /// From 10 K to 10 K + 50 K, of which 1 - 1/e after one time constant.
    #[test]
    fn coils_follow_their_warming_surroundings() {
        let setting = EffectSetting::typical_variant(&CoilAmbientTemperature, &ABOUT.variants[1])
            .with("difference_k", 10.0)
            .with("rise_k", 50.0)
            .with("warm_up_s", 0.5);
        let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        for (at_ns, risen) in [(500_000_000, 1.0 - (-1.0_f64).exp()), (20_000_000_000, 1.0)] {
            simulator.advance_to_ns(at_ns);
            let expected = 24.0 / (82.2 * (1.0 + 0.0039 * (10.0 + 50.0 * risen)));
            let current = simulator.sample().current[0];
            assert!(
                (current / expected - 1.0).abs() < 2e-3,
                "{current} {expected}"
            );
        }
    }
}
