//! Magnetic force on the armature (equations 3.7 to 3.10).

/// F_M = c i² / (gap - x)², with c = μ0 A_p N² / 2.
#[derive(Debug, Clone, PartialEq)]
pub struct Magnet {
    /// c [N m²/A²].
    pub force_constant: f64,
    /// Effective air gap with the armature at x = 0 [m].
    pub gap: f64,
}

impl Magnet {
    /// Force in the direction of +x [N] (equation 3.10).
    #[inline]
    pub fn force(&self, current: f64, x: f64) -> f64 {
        let ratio = current / (self.gap - x);
        self.force_constant * ratio * ratio
    }

    /// The current [A] at which the force reaches `force` [N] in position `x`; zero where no force
    /// is needed.
    #[inline]
    pub fn current_for(&self, force: f64, x: f64) -> f64 {
        (self.gap - x) * (force.max(0.0) / self.force_constant).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn current_for_inverts_the_force() {
        let magnet = Magnet {
            force_constant: 5.384e-3,
            gap: 8e-3,
        };
        let current = magnet.current_for(3.58, 0.1e-3);
        assert!((magnet.force(current, 0.1e-3) - 3.58).abs() < 1e-12);
        assert_eq!(magnet.current_for(-1.0, 0.0), 0.0);
    }
}
