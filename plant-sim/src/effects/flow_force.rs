//! Effect: the pressure force on the armature falls with the lift.

use crate::additions;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.flow_force":
    LOST = lost_share [""] 0.001 ..= 2.0, Linear 0.5, off 0.0,
        "share of the pressure force that is lost at full lift (E58); beyond 1 the flow pulls the valve shut";
    KNEE = knee_lift_share [""] 0.01 ..= 10.0, Log 0.2,
        "share of the stroke that makes the loss steep near the seat (E58): there half of it has come, if it is small";
}

static ABOUT: About = About {
    id: "flow_force",
    sentence: "Once air flows past the seat, the pressure no longer pushes on the armature as it did on the closed seat, so an open valve needs more current to stay open.",
    source: "E58: thesis, section 5.1.4; Merritt, Hydraulic Control Systems, section 5.6, for the force of the flow",
    acts_on: EntryPoint::Armature,
    variants: &[
        Variant {
            name: "linear",
            about: "in proportion to the lift",
            parameters: &[&LOST],
        },
        Variant {
            name: "steep",
            about: "most of it near the seat, where the gap is still narrower than the bore",
            parameters: &[&LOST, &KNEE],
        },
    ],
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
        plant.additions.flow_force = additions::FlowForce {
            at_full_lift: setting.value("lost_share"),
            steepness: match setting.variant().name {
                "steep" => 1.0 / setting.value("knee_lift_share"),
                _ => 0.0,
            },
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{ValveId, opening_duty_pct};
    use crate::{Command, Simulator};

    /// On the seat the full pressure force acts, so the valve opens at the same duty cycle. An open valve has less
    /// force that keeps it open.
    #[test]
    fn the_valve_opens_as_before_and_closes_earlier() {
        let plain = PlantParameters::nominal();
        let lossy = plain.with_effect(EffectSetting::typical(&FlowForce).with("lost_share", 1.0));
        // The armature leaves its seat at the same duty cycle but may not travel far, so the detected opening duty may
        // be up to 10 % higher.
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

    /// A valve hovers between its stops under a constant current, with a chamber too large to fill. At its position the
    /// forces of E7, E8 and E58, written out, balance.
    #[test]
    fn the_opening_pressure_force_is_lost_in_proportion_to_the_lift() {
        let mut plant = PlantParameters::nominal()
            .with_effect(EffectSetting::typical(&FlowForce).with("lost_share", 0.5));
        plant.ecu.supply_voltage_v = 12.0;
        plant.chamber.volume_m3 = 1.0;
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        simulator.advance_to_ns(1_000_000_000);
        let x = simulator.state().valves[0].x;
        assert!(x > 0.02e-3 && x < 0.48e-3, "{x}");
        let drop = plant.gas.supply_pressure_pa() - simulator.state().pressure;
        let ratio = 12.0 / plant.coil.resistance_20c_ohm / (plant.magnet.gap_closed_m - x);
        let magnet = plant.magnet.force_constant_n_m2_per_a2 * ratio * ratio;
        let area = core::f64::consts::PI / 4.0 * plant.armature.pressure_force_diameter_m.powi(2);
        let pressure = area * drop * (1.0 - 0.5 * x / plant.armature.stroke_m);
        let spring = plant.armature.preload_fill_n + plant.armature.spring_n_per_m * x;
        let net = magnet + pressure - spring;
        assert!(net.abs() < 1e-3, "{net} N at {x}");
    }

    /// By hand: at ξ = 0.1 with ρ = 0.1, (1 + 0.1) 0.1/0.2 = 0.55; at full lift the share itself; large knees are
    /// linear.
    #[test]
    fn a_steep_loss_comes_near_the_seat_and_ends_at_the_same_share() {
        let steep = |knee: f64| additions::FlowForce {
            at_full_lift: 0.4,
            steepness: 1.0 / knee,
        };
        for (knee, lift, expected) in [
            (0.1, 0.1, 0.4 * 0.55),
            (0.1, 1.0, 0.4),
            (0.1, 0.0, 0.0),
            (1e9, 0.3, 0.4 * 0.3),
        ] {
            let share = steep(knee).lost_share(lift);
            assert!((share - expected).abs() < 1e-9, "{share} at {lift}");
        }
        let variant = &ABOUT.variants[1];
        let setting = EffectSetting::typical_variant(&FlowForce, variant);
        let plant = PlantParameters::nominal().with_effect(setting.with("knee_lift_share", 0.25));
        assert_eq!(plant.plant().additions.flow_force.steepness, 4.0);
    }
}
