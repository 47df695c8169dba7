//! The coils are not at 20 °C.

use crate::additions::resistance;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.coil_ambient_temperature":
    DIFFERENCE = difference_k ["K"] -70.0 ..= 130.0, Linear 30.0, off 0.0,
        "what the surroundings of the coils are warmer than 20 degC (E42)";
}

static ABOUT: About = About {
    id: "coil_ambient_temperature",
    sentence: "The valves are hotter or colder than on the bench, so the copper takes less or more current from the same battery.",
    source: "E42: thesis, equation 5.7",
    acts_on: EntryPoint::Coil,
    variants: &[Variant {
        name: "uniform",
        about: "both coils alike, from the beginning",
        parameters: &[&DIFFERENCE],
    }],
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
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::steady_current;

    /// 80 K make copper a third more resistive: 24 V / (82.2 Ω · 1.312).
    #[test]
    fn a_hot_coil_takes_the_current_of_equation_5_7() {
        let hot = EffectSetting::typical(&CoilAmbientTemperature).with("difference_k", 80.0);
        let plant = PlantParameters::nominal().with_effect(hot);
        let [mean, ..] = steady_current(&plant, 100.0);
        assert!((mean - 24.0 / (82.2 * 1.312)).abs() < 1e-9, "{mean}");
    }
}
