//! Effect: eddy currents in the iron.

use crate::additions::EddyLoop;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.eddy_currents":
    RESISTANCE = loop_resistance_ohm ["ohm"] 10.0 ..= 1e6, Log 1000.0, off f64::INFINITY,
        "resistance of the eddy currents' loop, referred to the coil (E45)";
    STRAY = stray_time_s ["s"] 5e-5 ..= 0.02, Log 7e-4,
        "time constant of that loop: its stray inductance per resistance (E45)";
}

static ABOUT: About = About {
    id: "eddy_currents",
    sentence: "Currents in the solid iron hold the magnet's flux for a moment: the coil current jumps at each switching, and the valve releases late.",
    source: "E45: resistance parallel to the magnetising inductance, as the core loss of a transformer (Fitzgerald, Electric Machinery, section 2.4)",
    acts_on: EntryPoint::Coil,
    variants: &[
        Variant {
            name: "parallel",
            about: "one loop around the whole flux",
            parameters: &[&RESISTANCE],
        },
        Variant {
            name: "stray_inductance",
            about: "one loop with a stray inductance: the eddy current rises with a delay",
            parameters: &[&RESISTANCE, &STRAY],
        },
    ],
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
        plant.additions.eddy_loop = EddyLoop {
            conductance: setting.value("loop_resistance_ohm").recip(),
            time_constant: setting.get("stray_time_s").unwrap_or(0.0),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator, Tolerance};

    const VOLTAGE: f64 = 24.0;
    const DIODE_V: f64 = 0.8;
    const RESISTANCE_OHM: f64 = 82.2;
    const INDUCTANCE_H: f64 = 0.44;

    /// Returns the thesis' rig with `setting` and a fill valve that its preload keeps shut.
    fn resting(setting: EffectSetting) -> Simulator {
        let mut plant = PlantParameters::nominal().with_effect(setting);
        plant.armature.preload_fill_n = 100.0;
        plant.ecu.command_delay_s = 0.0;
        Simulator::with_tolerance(&plant, Tolerance::scaled(0.03))
    }

    fn stray(loop_ohm: f64, stray_s: f64) -> EffectSetting {
        let variant = ABOUT.variant("stray_inductance").unwrap();
        EffectSetting::typical_variant(&EddyCurrents, variant)
            .with("loop_resistance_ohm", loop_ohm)
            .with("stray_time_s", stray_s)
    }

    fn command(simulator: &mut Simulator, duty_fill_pct: f64) {
        simulator.command(Command {
            duty_fill_pct,
            duty_vent_pct: 0.0,
        });
    }

    /// With a resting armature: i = i_m + (e - R i_m)/(R + R_e), and i_m charges at R/L · R_e/(R + R_e).
    #[test]
    fn the_current_jumps_and_then_charges_more_slowly() {
        let mut simulator = resting(EffectSetting::typical(&EddyCurrents));
        command(&mut simulator, 100.0);
        let loop_r = 1000.0;
        for time_us in [1_u64, 100, 2000, 8000] {
            simulator.advance_to_ns(time_us * 1000);
            let t = time_us as f64 * 1e-6;
            let magnetising = VOLTAGE / RESISTANCE_OHM
                * -(-t * RESISTANCE_OHM / INDUCTANCE_H * loop_r / (RESISTANCE_OHM + loop_r))
                    .exp_m1();
            let expected =
                magnetising + (VOLTAGE - RESISTANCE_OHM * magnetising) / (RESISTANCE_OHM + loop_r);
            let current = simulator.sample().current[0];
            assert!(
                (current - expected).abs() < 2e-5,
                "{time_us} µs: {current} {expected}"
            );
        }
    }

    /// Magnetising and eddy current, by Euler steps of 20 ns: on for 5 ms, and off until the next period.
    fn euler(loop_ohm: f64, stray_s: f64, until_us: u64) -> f64 {
        let (mut magnetising, mut eddy, mut current) = (0.0, 0.0, 0.0);
        let (step, steps) = (20e-9, until_us * 50);
        for n in 0..steps {
            let voltage = if n < 250_000 { VOLTAGE } else { -DIODE_V };
            current = magnetising + eddy;
            let flux_rate = if current <= 0.0 && voltage < 0.0 {
                current = 0.0;
                // Blocked: the eddy current is the negative magnetising current.
                -loop_ohm * magnetising / (1.0 + loop_ohm * stray_s / INDUCTANCE_H)
            } else {
                voltage - RESISTANCE_OHM * current
            };
            magnetising += step * flux_rate / INDUCTANCE_H;
            eddy += step * (flux_rate / loop_ohm - eddy) / stray_s;
        }
        current
    }

    #[test]
    fn with_stray_inductance_the_current_follows_both_loops() {
        let (loop_ohm, stray_s) = (300.0, 7e-4);
        let mut simulator = resting(stray(loop_ohm, stray_s));
        command(&mut simulator, 50.0);
        for time_us in [100_u64, 1000, 4900, 5100, 6000, 9900] {
            simulator.advance_to_ns(time_us * 1000);
            let expected = euler(loop_ohm, stray_s, time_us);
            let current = simulator.sample().current[0];
            assert!(
                (current - expected).abs() < 1e-5,
                "{time_us} µs: {current} {expected}"
            );
        }
    }

    /// Once the diode blocks, the flux decays with the loop's own time constant: (L + L_e)/R_e.
    #[test]
    fn the_flux_of_a_blocked_coil_decays_with_the_loop() {
        let (loop_ohm, stray_s) = (20.0, 5e-3);
        let mut simulator = resting(stray(loop_ohm, stray_s));
        command(&mut simulator, 50.0);
        simulator.advance_to_ns(9_000_000);
        let eddy = |simulator: &Simulator| {
            let mut states = simulator.effect_states();
            states
                .find(|state| state.name == "i_eddy_fill")
                .unwrap()
                .value
        };
        assert_eq!(simulator.sample().current[0], 0.0, "the diode blocks");
        let start = eddy(&simulator);
        simulator.advance_to_ns(9_900_000);
        let expected = start * (-0.9e-3 / (stray_s + INDUCTANCE_H / loop_ohm)).exp();
        let eddy = eddy(&simulator);
        assert!(start < -1e-3, "{start}");
        assert!((eddy - expected).abs() < 1e-5, "{eddy} {expected}");
    }

    /// Six stray times after each edge at 0 and 6 ms of a period.
    #[test]
    fn a_short_stray_time_is_the_parallel_loop() {
        let currents = |setting: EffectSetting| {
            let mut simulator = resting(setting);
            command(&mut simulator, 60.0);
            let mut current_at = |time_us: u64| {
                simulator.advance_to_ns(time_us * 1000);
                simulator.sample().current[0]
            };
            let periods = (0..8).map(|period| 10_000 * period);
            periods
                .flat_map(|start| [300, 5900, 6300, 9900].map(|after| start + after))
                .map(&mut current_at)
                .collect::<Vec<_>>()
        };
        let parallel = EffectSetting::typical(&EddyCurrents);
        let loop_ohm = parallel.value("loop_resistance_ohm");
        let found = currents(parallel).into_iter();
        for (n, (one, other)) in found.zip(currents(stray(loop_ohm, 5e-5))).enumerate() {
            assert!((one - other).abs() < 3e-4, "{n}: {one} {other}");
        }
    }
}
