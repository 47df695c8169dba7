//! Effect: dry friction of the armature.

use crate::additions::Friction;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.static_friction":
    FRICTION = friction_n ["N"] 1e-3 ..= 50.0, Log 0.2, off 0.0,
        "friction that a resting armature must overcome (E47)";
    SLIDING = sliding_share [""] 0.0 ..= 1.0, Linear 0.7,
        "friction of the moving armature over that of the resting one (E47)";
}

static ABOUT: About = About {
    id: "static_friction",
    sentence: "The armature sticks: it needs some extra force to move at all and stops in places where it should creep on.",
    source: "E47: thesis, equations 3.11 and 4.1; Olsson et al., Friction models and friction compensation, 1998",
    acts_on: EntryPoint::Armature,
    variants: &[
        Variant {
            name: "coulomb",
            about: "the same friction at rest and in motion",
            parameters: &[&FRICTION],
        },
        Variant {
            name: "breakaway",
            about: "less friction once it slides",
            parameters: &[&FRICTION, &SLIDING],
        },
    ],
    excited_by: "duty cycles just around the opening and the holding duty, up and down",
    confused_with: &["flow_force", "end_stop_bounce", "coil_ambient_temperature"],
};

/// The effect.
#[derive(Debug)]
pub struct StaticFriction;

impl Effect for StaticFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        let at_rest = setting.value("friction_n");
        plant.additions.friction = Some(Friction {
            at_rest,
            sliding: at_rest * setting.get("sliding_share").unwrap_or(1.0),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{ValveId, opening_duty_pct};

    fn with(friction_n: f64) -> PlantParameters {
        PlantParameters::nominal()
            .with_effect(EffectSetting::typical(&StaticFriction).with("friction_n", friction_n))
    }

    /// At the stop, friction acts like preload: the same current overcomes both (equation 4.1).
    #[test]
    fn friction_asks_for_the_duty_that_as_much_preload_asks_for() {
        let mut preloaded = PlantParameters::nominal();
        preloaded.armature.preload_fill_n += 0.3;
        let [stuck, preloaded] = [with(0.3), preloaded]
            .map(|plant| opening_duty_pct(&plant, ValveId::Fill, true).unwrap());
        assert!((stuck - preloaded).abs() < 0.5, "{stuck} {preloaded}");
    }

    /// A released spring-mass system comes to rest within the band |net force| ≤ F_s, not at its equilibrium.
    #[test]
    fn the_armature_rests_off_its_balance() {
        let mut plant = with(0.2);
        // A constant voltage at which the armature hovers between its stops, and a chamber that never fills.
        plant.ecu.supply_voltage_v = 12.0;
        plant.chamber.volume_m3 = 1.0;
        plant.armature.viscous_friction_ns_per_m = 0.0;
        let mut simulator = crate::Simulator::new(&plant);
        simulator.command(crate::Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        simulator.advance_to_ns(3_000_000_000);
        let valve = simulator.state().valves[0];
        let physics = simulator.plant();
        let force = physics.valves[0].magnet.force(valve.current, valve.x)
            + physics.valves[0].armature.static_force(
                valve.x,
                physics.pressure_drop(0, simulator.state().pressure),
            );
        assert_eq!(valve.v, 0.0);
        assert!(valve.x > 0.0 && valve.x < 0.5e-3, "{valve:?}");
        assert!((0.01..=0.2).contains(&force.abs()), "{force}");
    }
}
