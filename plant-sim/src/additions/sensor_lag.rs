//! Output of a slow sensor (E54).

/// Lag of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorLag {
    /// Time constant of each stage (s).
    pub time_constant: f64,
    /// Whether a second stage follows the first: the sensor, and then its filter.
    pub is_second_order: bool,
}

impl SensorLag {
    /// Returns the outputs of the stages after `h` (s). The input is a cubic through both ends with these slopes, and
    /// the previous outputs are `shown`. The output of the sensor is the last one. Exact for the cubic.
    pub(crate) fn follow(
        &self,
        shown: [f64; 2],
        h: f64,
        [start, start_rate]: [f64; 2],
        [end, end_rate]: [f64; 2],
    ) -> [f64; 2] {
        // u = a + b s + c s² + d s³ with s = t/h.
        let rise = end - start;
        let trace = [
            h * start_rate,
            3.0 * rise - h * (2.0 * start_rate + end_rate),
            h * (start_rate + end_rate) - 2.0 * rise,
        ];
        let z = h / self.time_constant;
        let once = responses(z);
        let after = |shown: f64, to: &[f64]| {
            let pairs = trace.iter().zip(&to[1..]);
            shown + (start - shown) * to[0] + pairs.map(|(c, to)| c * to).sum::<f64>()
        };
        let first = after(shown[0], &once);
        if !self.is_second_order {
            return [first; 2];
        }
        // The state of the first stage adds z exp(-z) of itself to the second.
        let twice: [f64; 4] = core::array::from_fn(|n| z * (once[n] - once[n + 1]));
        let held = (shown[0] - shown[1]) * z * (-z).exp();
        [first, after(shown[1], &twice) + held]
    }
}

/// Returns g_n(z) = z ∫₀¹ exp(-z (1 - s)) sⁿ ds for n = 0 to 4: the output of a lag from zero for the input sⁿ at s =
/// 1; two lags give z (g_n - g_(n+1)). The recursion g_n = 1 - n g_(n-1) / z is stable upwards for large z and
/// downwards for small z.
fn responses(z: f64) -> [f64; 5] {
    if z >= 1.0 {
        let g0 = -(-z).exp_m1();
        let g1 = 1.0 - g0 / z;
        let g2 = 1.0 - 2.0 * g1 / z;
        let g3 = 1.0 - 3.0 * g2 / z;
        [g0, g1, g2, g3, 1.0 - 4.0 * g3 / z]
    } else {
        // g_4 = Σ (-1)^k z^(k+1) 4! / (k + 5)!, an alternating series.
        let terms = (6..22).scan(z / 5.0, |term, n| {
            let this = *term;
            *term *= -z / f64::from(n);
            Some(this)
        });
        let g4: f64 = terms.sum();
        let g3 = (1.0 - g4) * z / 4.0;
        let g2 = (1.0 - g3) * z / 3.0;
        let g1 = (1.0 - g2) * z / 2.0;
        [(1.0 - g1) * z, g1, g2, g3, g4]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with the integrals by Simpson's rule; tiny steps once had rounding errors of 1e20 Pa.
    #[test]
    fn responses_are_their_integrals() {
        for z in [1e-9, 1e-3, 0.3, 0.999, 1.0, 3.0, 50.0_f64] {
            let once = responses(z);
            for (n, &found) in once.iter().enumerate() {
                let f = |s: f64| z * (-z * (1.0 - s)).exp() * s.powi(n as i32);
                let sum = integral(f);
                assert!((found - sum).abs() < 1e-9 * sum, "{z} {n}: {found} {sum}");
            }
            for n in 0..4 {
                let f = |s: f64| z * z * (1.0 - s) * (-z * (1.0 - s)).exp() * s.powi(n as i32);
                let (found, sum) = (z * (once[n] - once[n + 1]), integral(f));
                assert!((found - sum).abs() < 1e-8 * sum, "{z} {n}: {found} {sum}");
            }
        }
    }

    fn integral(f: impl Fn(f64) -> f64) -> f64 {
        let cells = 2000;
        let cell = |n: u32| {
            let [a, b] = [n, n + 1].map(|n| f64::from(n) / f64::from(cells));
            (b - a) / 6.0 * (f(a) + 4.0 * f(0.5 * (a + b)) + f(b))
        };
        (0..cells).map(cell).sum()
    }

    /// A ramp is followed with a delay of slope times time constant per stage, and the initial difference decays.
    #[test]
    fn ramps_are_followed_at_a_distance() {
        let after = |is_second_order, shown: f64, h: f64| {
            let lag = SensorLag {
                time_constant: 0.01,
                is_second_order,
            };
            lag.follow([shown; 2], h, [0.0, 2.0], [2.0 * h, 2.0])[1]
        };
        for h in [1e-12, 1e-9, 1e-4, 0.99e-2, 1e-2, 0.3] {
            let (z, decay) = (h / 0.01, (-h / 0.01_f64).exp());
            let first = 2.0 * (h - 0.01) + (0.5 + 0.02) * decay;
            let second = 2.0 * (h - 0.02) + (0.5 + 0.04) * decay + (0.5 + 0.02) * z * decay;
            assert!((after(false, 0.5, h) - first).abs() < 1e-12, "{h}");
            assert!((after(true, 0.5, h) - second).abs() < 1e-12, "{h}");
        }
    }

    /// One long step gives the same result as many short ones.
    #[test]
    fn two_stages_go_on_from_where_they_are() {
        let lag = SensorLag {
            time_constant: 0.01,
            is_second_order: true,
        };
        let ramp = |shown, from: f64, h: f64| lag.follow(shown, h, [from, 1.0], [from + h, 1.0]);
        let once = ramp([0.3, -0.2], 0.0, 0.02);
        let twice = ramp(ramp([0.3, -0.2], 0.0, 0.005), 0.005, 0.015);
        assert!((once[0] - twice[0]).abs() < 1e-14 && (once[1] - twice[1]).abs() < 1e-14);
    }
}
