//! What a first-order lag shows (E54).

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
