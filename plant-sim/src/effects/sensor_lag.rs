//! The pressure sensor is slow.

use super::{About, Effect, EffectSetting, EntryPoint, Variant};
use crate::parameters::{PlantParameters, effect_parameters};
use crate::plant::Plant;

effect_parameters! { "effects.sensor_lag":
    TIME_CONSTANT = time_constant_s ["s"] 1e-5 ..= 2.0, Log 0.01, off 0.0,
        "time constant of the sensor with its filter (E54)";
}

static ABOUT: About = About {
    id: "sensor_lag",
    sentence: "Sensor and filter show the pressure late, so it seems to go on for a while after the valves are shut.",
    source: "E54: first-order lag",
    acts_on: EntryPoint::Sensor,
    variants: &[Variant {
        name: "first_order",
        about: "one time constant",
        parameters: &[&TIME_CONSTANT],
    }],
    excited_by: "single pulses with pauses; a PWM frequency that is no divisor of the sample rate",
    confused_with: &["dead_volume", "gas_temperature"],
};

/// The effect.
#[derive(Debug)]
pub struct SensorLag;

/// What a first-order lag shows after `h` (s) of an input that goes as a cubic through both ends with these slopes,
/// when it showed `shown` before. Exact for the cubic.
pub(crate) fn lagged(
    shown: f64,
    time_constant: f64,
    h: f64,
    [start, start_rate]: [f64; 2],
    [end, end_rate]: [f64; 2],
) -> f64 {
    // u = a + b s + c s² + d s³ with s = t/h.
    let rise = end - start;
    let (b, c, d) = (
        h * start_rate,
        3.0 * rise - h * (2.0 * start_rate + end_rate),
        h * (start_rate + end_rate) - 2.0 * rise,
    );
    let z = h / time_constant;
    let [to_1, to_s, to_s2, to_s3] = responses(z);
    shown + (start - shown) * to_1 + b * to_s + c * to_s2 + d * to_s3
}

/// g_n(z) = z ∫₀¹ exp(-z (1 - s)) sⁿ ds for n = 0 to 3: what a lag from zero shows of the input sⁿ at s = 1. They
/// follow from each other by g_n = 1 - n g_(n-1) / z, which is stable upwards for large z and downwards for small.
fn responses(z: f64) -> [f64; 4] {
    if z >= 1.0 {
        let g0 = -(-z).exp_m1();
        let g1 = 1.0 - g0 / z;
        let g2 = 1.0 - 2.0 * g1 / z;
        [g0, g1, g2, 1.0 - 3.0 * g2 / z]
    } else {
        // g_3 = Σ (-1)^k z^(k+1) 3! / (k + 4)!, an alternating series.
        let terms = (5..22).scan(z / 4.0, |term, n| {
            let this = *term;
            *term *= -z / f64::from(n);
            Some(this)
        });
        let g3: f64 = terms.sum();
        let g2 = (1.0 - g3) * z / 3.0;
        let g1 = (1.0 - g2) * z / 2.0;
        [(1.0 - g1) * z, g1, g2, g3]
    }
}

impl Effect for SensorLag {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.sensor_lag = setting.value("time_constant_s");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator, Tolerance};

    /// Against the integral, by Simpson's rule; tiny steps once left 1e20 Pa of rounding.
    #[test]
    fn responses_are_their_integrals() {
        for z in [1e-9, 1e-3, 0.3, 0.999, 1.0, 3.0, 50.0_f64] {
            for (n, found) in responses(z).into_iter().enumerate() {
                let f = |s: f64| z * (-z * (1.0 - s)).exp() * s.powi(n as i32);
                let (cells, mut sum) = (2000, 0.0);
                for cell in 0..cells {
                    let [a, b] = [cell, cell + 1].map(|n| f64::from(n) / f64::from(cells));
                    sum += (b - a) / 6.0 * (f(a) + 4.0 * f(0.5 * (a + b)) + f(b));
                }
                assert!((found - sum).abs() < 1e-9 * sum, "{z} {n}: {found} {sum}");
            }
        }
    }

    /// A ramp is followed at a distance of slope times time constant, and a step decays.
    #[test]
    fn ramps_are_followed_at_a_distance() {
        let after = |shown: f64, h: f64| lagged(shown, 0.01, h, [0.0, 2.0], [2.0 * h, 2.0]);
        let expected = |shown: f64, h: f64| 2.0 * (h - 0.01) + (shown + 0.02) * (-h / 0.01).exp();
        for h in [1e-12, 1e-9, 1e-4, 0.99e-2, 1e-2, 0.3] {
            assert!((after(0.5, h) - expected(0.5, h)).abs() < 1e-12, "{h}");
        }
    }

    /// The sensor against a fine simulation of its own equation on the same chamber pressure.
    #[test]
    fn the_sensor_follows_the_simulated_pressure() {
        let plant = PlantParameters::nominal().with_effect(EffectSetting::typical(&SensorLag));
        let mut simulator = Simulator::with_tolerance(&plant, Tolerance::scaled(0.01));
        simulator.command(Command {
            duty_fill_pct: 60.0,
            duty_vent_pct: 0.0,
        });
        let mut fine = simulator.clone();
        let mut shown = fine.state().pressure;
        let (h, steps) = (1e-5, 1000_u64);
        for sample in 1..=30_u64 {
            for step in 1..=steps {
                let before = fine.state().pressure;
                fine.advance_to_ns((sample - 1) * 10_000_000 + step * 10_000);
                let middle = 0.5 * (before + fine.state().pressure);
                shown += (middle - shown) * -(-h / 0.01_f64).exp_m1();
            }
            simulator.advance_to_ns(sample * 10_000_000);
            let measured = simulator.sample().measured_pressure;
            assert!(
                (measured - shown).abs() < 20.0,
                "{sample}: {measured} {shown}"
            );
        }
    }
}
