//! Effect: the pressure sensor is slow.

use crate::additions;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.sensor_lag":
    TIME_CONSTANT = time_constant_s ["s"] 1e-5 ..= 2.0, Log 0.01, off 0.0,
        "time constant of the sensor with its filter (E54)";
}

static ABOUT: About = About {
    id: "sensor_lag",
    sentence: "Sensor and filter show the pressure late, so it seems to go on for a while after the valves are shut.",
    source: "E54: one lag, or two in a row",
    acts_on: EntryPoint::Sensor,
    variants: &[
        Variant {
            name: "first_order",
            about: "sensor or filter, one time constant",
            parameters: &[&TIME_CONSTANT],
        },
        Variant {
            name: "second_order",
            about: "sensor and filter in a row, each with this time constant",
            parameters: &[&TIME_CONSTANT],
        },
    ],
    excited_by: "single pulses with pauses; a PWM frequency that is no divisor of the sample rate",
    confused_with: &["dead_volume", "gas_temperature", "sensor_hysteresis"],
};

/// The effect.
#[derive(Debug)]
pub struct SensorLag;

impl Effect for SensorLag {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.sensor_lag = Some(additions::SensorLag {
            time_constant: setting.value("time_constant_s"),
            is_second_order: setting.variant().name == "second_order",
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator, Tolerance};

    /// Comparison of the sensor with a fine simulation of its own equations on the same chamber pressure.
    #[test]
    fn the_sensor_follows_the_simulated_pressure() {
        for variant in ABOUT.variants {
            let setting = EffectSetting::typical_variant(&SensorLag, variant);
            let plant = PlantParameters::nominal().with_effect(setting);
            let mut simulator = Simulator::with_tolerance(&plant, Tolerance::scaled(0.01));
            simulator.command(Command {
                duty_fill_pct: 60.0,
                duty_vent_pct: 0.0,
            });
            let mut fine = simulator.clone();
            let stages = if variant.name == "second_order" { 2 } else { 1 };
            let mut shown = [fine.state().pressure; 2];
            let (steps, through) = (1000_u64, -(-1e-5 / 0.01_f64).exp_m1());
            for sample in 1..=30_u64 {
                for step in 1..=steps {
                    let before = fine.state().pressure;
                    fine.advance_to_ns((sample - 1) * 10_000_000 + step * 10_000);
                    let mut middle = 0.5 * (before + fine.state().pressure);
                    for stage in &mut shown[..stages] {
                        let began = *stage;
                        *stage += (middle - began) * through;
                        middle = 0.5 * (began + *stage);
                    }
                }
                simulator.advance_to_ns(sample * 10_000_000);
                let (measured, shown) = (simulator.sample().measured_pressure, shown[stages - 1]);
                assert!(
                    (measured - shown).abs() < 20.0,
                    "{}, {sample}: {measured} {shown}",
                    variant.name
                );
            }
        }
    }
}
