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
