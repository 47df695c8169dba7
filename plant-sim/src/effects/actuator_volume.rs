//! Effect: an actuator that is moved from outside changes the volume of the chamber.

use crate::additions::Actuator;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.actuator_volume":
    AREA = area_m2 ["m2"] -1.0 ..= 1.0, Linear 5e-4, off 0.0, driven_by "x_actuator",
        "area of the actuator on the side of the chamber; negative if the chamber shrinks as x_actuator grows (E74)";
}

static ABOUT: About = About {
    id: "actuator_volume",
    sentence: "A piston or a wall of the chamber is moved from outside, so the volume follows the logged position x_actuator.",
    source: "E74: mass balance of a chamber whose volume changes",
    acts_on: EntryPoint::Volume,
    variants: &[Variant::only(&[&AREA])],
    excited_by: "an actuator that moves while both valves are shut, with its position in the log",
    confused_with: &["regulating_valve_volume", "chamber_leak"],
};

/// The effect.
#[derive(Debug)]
pub struct ActuatorVolume;

impl Effect for ActuatorVolume {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.actuator = Some(Actuator {
            area: setting.value("area_m2"),
            velocity: 0.0,
        });
    }
}
