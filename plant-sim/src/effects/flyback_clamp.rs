//! Effect: the freewheeling current passes through more than a diode.

use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.flyback_clamp":
    DROP = extra_drop_v ["V"] 0.05 ..= 100.0, Log 20.0, off 0.0,
        "voltage against the freewheeling current beyond that of the diode (E49)";
    RESISTANCE = resistance_ohm ["ohm"] 0.1 ..= 2000.0, Log 50.0, off 0.0,
        "resistance in the freewheeling loop beside that of the coil (E49)";
}

static ABOUT: About = About {
    id: "flyback_clamp",
    sentence: "The ECU switches the coil off through a clamp instead of a plain diode, so the current dies faster and the valve closes earlier.",
    source: "E49: Kirchhoff's voltage law of the freewheeling loop",
    acts_on: EntryPoint::Coil,
    variants: &[
        Variant {
            name: "zener",
            about: "a constant voltage",
            parameters: &[&DROP],
        },
        Variant {
            name: "resistor",
            about: "a voltage in proportion to the current",
            parameters: &[&RESISTANCE],
        },
    ],
    excited_by: "scope log of the coil current after switching off; duty cycles of 30 to 60 %",
    confused_with: &["eddy_currents", "iron_saturation"],
};

/// The effect.
#[derive(Debug)]
pub struct FlybackClamp;

impl Effect for FlybackClamp {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.diode_drop += setting.get("extra_drop_v").unwrap_or(0.0);
        plant.additions.freewheeling_resistance = setting.get("resistance_ohm").unwrap_or(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    /// E5 with the clamp in the loop: i reaches zero after L/(R + R_c) ln(1 + i_0 (R + R_c)/V).
    #[test]
    fn the_current_ends_when_the_clamp_says() {
        for (variant, key, value, drop, loop_resistance) in [
            ("zener", "extra_drop_v", 20.0, 20.8, 82.2),
            ("resistor", "resistance_ohm", 50.0, 0.8, 132.2),
        ] {
            let setting =
                EffectSetting::typical_variant(&FlybackClamp, ABOUT.variant(variant).unwrap())
                    .with(key, value);
            let mut plant = PlantParameters::nominal().with_effect(setting);
            plant.armature.preload_fill_n = 100.0;
            plant.ecu.command_delay_s = 0.0;
            let mut simulator = Simulator::new(&plant);
            for (at_ns, duty_fill_pct) in [(0, 100.0), (100_000_000, 0.0)] {
                simulator.advance_to_ns(at_ns);
                simulator.command(Command {
                    duty_fill_pct,
                    duty_vent_pct: 0.0,
                });
            }
            let start = 24.0 / 82.2_f64;
            let end = 0.44 / loop_resistance * (start * loop_resistance / drop).ln_1p();
            for (share, flows) in [(0.99, true), (1.01, false)] {
                simulator.advance_to_ns(100_000_000 + (share * end * 1e9) as u64);
                let current = simulator.sample().current[0];
                assert_eq!(current > 0.0, flows, "{variant}: {current} at {share}");
            }
        }
    }
}
