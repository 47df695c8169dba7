//! Interpolation within a step from values and derivatives at its ends.

/// Cubic through two values with their slopes, over `h`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cubic {
    coefficients: [f64; 4],
}

impl Cubic {
    pub(crate) fn new(h: f64, start: f64, start_rate: f64, end: f64, end_rate: f64) -> Self {
        let mean = (end - start) / h;
        Self {
            coefficients: [
                start,
                start_rate,
                (3.0 * mean - 2.0 * start_rate - end_rate) / h,
                (start_rate + end_rate - 2.0 * mean) / (h * h),
            ],
        }
    }

    #[inline]
    pub(crate) fn at(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.coefficients;
        a + t * (b + t * (c + t * d))
    }

    /// Returns the first derivative.
    #[inline]
    pub(crate) fn rate_at(&self, t: f64) -> f64 {
        let [_, b, c, d] = self.coefficients;
        b + t * (2.0 * c + t * 3.0 * d)
    }
}

/// Quintic through two positions with their velocities and accelerations, over `h`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quintic {
    coefficients: [f64; 6],
}

impl Quintic {
    /// Creates the quintic from `start` and `end`, each (position, velocity, acceleration).
    pub(crate) fn new(h: f64, start: [f64; 3], end: [f64; 3]) -> Self {
        let [x0, v0, a0] = start;
        // Deviation of a parabola from the start at the end.
        let x = (end[0] - x0 - h * (v0 + h * a0 / 2.0)) / (h * h * h);
        let v = (end[1] - v0 - h * a0) / (h * h);
        let a = (end[2] - a0) / h;
        Self {
            coefficients: [
                x0,
                v0,
                a0 / 2.0,
                10.0 * x - 4.0 * v + a / 2.0,
                (-15.0 * x + 7.0 * v - a) / h,
                (6.0 * x - 3.0 * v + a / 2.0) / (h * h),
            ],
        }
    }

    #[inline]
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.coefficients
            .iter()
            .rev()
            .fold(0.0, |sum, coefficient| sum * t + coefficient)
    }

    /// Returns the first derivative.
    #[inline]
    pub(crate) fn rate_at(&self, t: f64) -> f64 {
        let weighted = self.coefficients.iter().enumerate().skip(1);
        weighted.rev().fold(0.0, |sum, (power, coefficient)| {
            sum * t + power as f64 * coefficient
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_reproduces_a_cubic() {
        let f = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t - 3.0 * t * t * t;
        let df = |t: f64| -2.0 + t - 9.0 * t * t;
        let cubic = Cubic::new(0.7, f(0.0), df(0.0), f(0.7), df(0.7));
        for t in [0.0, 0.2, 0.5, 0.7] {
            assert!((cubic.at(t) - f(t)).abs() < 1e-14);
            assert!((cubic.rate_at(t) - df(t)).abs() < 1e-13);
        }
    }

    #[test]
    fn quintic_reproduces_a_quintic() {
        let c = [0.3, -1.0, 2.0, -4.0, 1.5, 7.0];
        let derivative = |order: u32, t: f64| -> f64 {
            (order..6)
                .map(|n| {
                    let falling: f64 = (0..order).map(|k| f64::from(n - k)).product();
                    c[n as usize] * falling * t.powi((n - order) as i32)
                })
                .sum()
        };
        let ends = [0.0, 0.9].map(|t| [0, 1, 2].map(|order| derivative(order, t)));
        let quintic = Quintic::new(0.9, ends[0], ends[1]);
        for t in [0.1, 0.45, 0.8, 0.9] {
            assert!((quintic.at(t) - derivative(0, t)).abs() < 1e-12);
            assert!((quintic.rate_at(t) - derivative(1, t)).abs() < 1e-11);
        }
    }
}
