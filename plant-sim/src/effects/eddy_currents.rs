//! Effect: eddy currents in the iron.

use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.eddy_currents":
    RESISTANCE = loop_resistance_ohm ["ohm"] 10.0 ..= 1e6, Log 1000.0, off f64::INFINITY,
        "resistance of the eddy currents' loop, referred to the coil (E45)";
}

static ABOUT: About = About {
    id: "eddy_currents",
    sentence: "Currents in the solid iron hold the magnet's flux for a moment: the coil current jumps at each switching, and the valve releases late.",
    source: "E45: resistance parallel to the magnetising inductance, as the core loss of a transformer (Fitzgerald, Electric Machinery, section 2.4)",
    acts_on: EntryPoint::Coil,
    variants: &[Variant {
        name: "parallel",
        about: "one loop around the whole flux",
        parameters: &[&RESISTANCE],
    }],
    excited_by: "scope log of the coil current around a PWM edge",
    confused_with: &["iron_saturation", "flyback_clamp"],
};

/// The effect.
#[derive(Debug)]
pub struct EddyCurrents;

impl Effect for EddyCurrents {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.eddy_conductance = setting.value("loop_resistance_ohm").recip();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    /// With a resting armature: i = i_m + (e - R i_m)/(R + R_e), and i_m charges at R/L · R_e/(R + R_e).
    #[test]
    fn the_current_jumps_and_then_charges_more_slowly() {
        let mut plant =
            PlantParameters::nominal().with_effect(EffectSetting::typical(&EddyCurrents));
        // Kept shut by the preload: no motion.
        plant.armature.preload_fill_n = 100.0;
        plant.ecu.command_delay_s = 0.0;
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        let (e, r, loop_r, l) = (24.0, 82.2, 1000.0, 0.44);
        for time_us in [1_u64, 100, 2000, 8000] {
            simulator.advance_to_ns(time_us * 1000);
            let t = time_us as f64 * 1e-6;
            let magnetising = e / r * -(-t * r / l * loop_r / (r + loop_r)).exp_m1();
            let expected = magnetising + (e - r * magnetising) / (r + loop_r);
            let current = simulator.sample().current[0];
            assert!(
                (current - expected).abs() < 2e-5,
                "{time_us} µs: {current} {expected}"
            );
        }
    }
}
