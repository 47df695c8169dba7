//! Magnetic force on the armature (equations 3.7 to 3.10).

/// F_M = c i² / (gap - x)², with c = μ0 A_p N² / 2.
#[derive(Debug, Clone, PartialEq)]
pub struct Magnet {
    /// c (N m²/A²).
    pub force_constant: f64,
    /// Effective air gap with the armature at x = 0 (m).
    pub gap: f64,
}

impl Magnet {
    /// Returns the force in the direction of +x (N) (equation 3.10). The diode lets no negative current flow: one in a
    /// trial step, beyond the instant at which the diode blocks, does not attract.
    #[inline]
    pub fn force(&self, current: f64, x: f64) -> f64 {
        let ratio = current.max(0.0) / (self.gap - x);
        self.force_constant * ratio * ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equation 3.10 written out, and the nominal valve's force at the stop: 7.2 N at 292 mA.
    #[test]
    fn force_is_equation_3_10() {
        let magnet = Magnet {
            force_constant: 5.384e-3,
            gap: 8e-3,
        };
        let expected = 5.384e-3 * 0.292 * 0.292 / (7.9e-3 * 7.9e-3);
        assert!((magnet.force(0.292, 0.1e-3) / expected - 1.0).abs() < 1e-14);
        assert!((magnet.force(0.292, 0.0) - 7.17).abs() < 0.01);
    }
}
