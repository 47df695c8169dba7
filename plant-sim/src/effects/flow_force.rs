//! The pressure force on the armature falls with the lift.

use super::{About, Effect, EffectSetting, EntryPoint, Variant};
use crate::parameters::{PlantParameters, effect_parameters};
use crate::plant::Plant;

effect_parameters! { "effects.flow_force":
    LOST = lost_share [""] 0.001 ..= 2.0, Linear 0.5, off 0.0,
        "share of the pressure force that is lost at full lift (E58); beyond 1 the flow pulls the valve shut";
}

static ABOUT: About = About {
    id: "flow_force",
    sentence: "Once air flows past the seat, the pressure no longer pushes on the armature as it did on the closed seat, so an open valve needs more current to stay open.",
    source: "E58: thesis, section 5.1.4; Merritt, Hydraulic Control Systems, section 5.6, for the force of the flow",
    acts_on: EntryPoint::Armature,
    variants: &[Variant {
        name: "linear",
        about: "in proportion to the lift",
        parameters: &[&LOST],
    }],
    excited_by: "duty cycles between opening and holding duty with full supply pressure across the valve",
    confused_with: &["static_friction", "end_stop_bounce"],
};

/// The effect.
#[derive(Debug)]
pub struct FlowForce;

impl Effect for FlowForce {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.flow_force = setting.value("lost_share");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{ValveId, opening_duty_pct};
    use crate::{Command, Simulator};

    /// On the seat the whole force acts: the valve opens no later. Open, it has less to hold it.
    #[test]
    fn the_valve_opens_as_before_and_closes_earlier() {
        let plain = PlantParameters::nominal();
        let lossy = plain.with_effect(EffectSetting::typical(&FlowForce).with("lost_share", 1.0));
        // Leaves its seat at the same duty, but may not get far: watch a duty well above.
        let duty = |plant: &PlantParameters| opening_duty_pct(plant, ValveId::Fill, true).unwrap();
        assert!(duty(&lossy) >= duty(&plain) && duty(&lossy) < duty(&plain) + 10.0);
        let lift = |plant: &PlantParameters| {
            let mut simulator = Simulator::new(plant);
            simulator.command(Command {
                duty_fill_pct: 60.0,
                duty_vent_pct: 0.0,
            });
            (0..1000_u64)
                .map(|step| {
                    simulator.advance_to_ns(30_000_000 + step * 10_000);
                    simulator.state().valves[0].x
                })
                .sum::<f64>()
        };
        assert!(
            lift(&lossy) < 0.9 * lift(&plain),
            "{} {}",
            lift(&lossy),
            lift(&plain)
        );
    }
}
