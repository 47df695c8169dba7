//! Effect: the armature bounces off its end stops.

use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.end_stop_bounce":
    RESTITUTION = restitution [""] 0.01 ..= 0.9, Linear 0.3, off 0.0,
        "velocity after over velocity before an end stop is met (E48)";
}

static ABOUT: About = About {
    id: "end_stop_bounce",
    sentence: "The armature rebounds from its seat and its end stop, so the valve opens again for a fraction of a millisecond after it has closed.",
    source: "E48: Newton's law of impact",
    acts_on: EntryPoint::Armature,
    variants: &[Variant {
        name: "newton",
        about: "the same share of the velocity at both stops",
        parameters: &[&RESTITUTION],
    }],
    excited_by: "short pulses that just open the valve, and a scope log of the current around the closing",
    confused_with: &["static_friction", "flow_force"],
};

/// The effect.
#[derive(Debug)]
pub struct EndStopBounce;

impl Effect for EndStopBounce {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.restitution = setting.value("restitution");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::additions::SLOWEST_BOUNCE;
    use crate::{Command, Simulator};

    /// Each flight after a bounce begins with the share of the velocity that the arrival had.
    #[test]
    fn velocities_before_and_after_a_stop_have_the_ratio_of_the_restitution() {
        let plant = PlantParameters::nominal()
            .with_effect(EffectSetting::typical(&EndStopBounce).with("restitution", 0.5));
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        let mut bounces = Vec::new();
        let mut last = 0.0;
        for step in 0..50_000_u64 {
            simulator.advance_to_ns(step * 1000);
            let v = simulator.state().valves[0].v;
            if last > SLOWEST_BOUNCE && v < 0.0 {
                bounces.push(-v / last);
            }
            last = v;
        }
        assert!(!bounces.is_empty());
        for ratio in bounces {
            assert!((ratio - 0.5).abs() < 0.02, "{ratio}");
        }
        let valve = simulator.state().valves[0];
        assert_eq!((valve.x, valve.v), (0.5e-3, 0.0), "it comes to rest");
    }
}
