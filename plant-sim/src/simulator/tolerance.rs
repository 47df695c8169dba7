//! Accuracy of the solution.

/// Allowed local error per step, for pressure (Pa), current (A), position (m), velocity (m/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Chamber pressure (Pa).
    pub pressure: f64,
    /// Coil current (A).
    pub current: f64,
    /// Armature position (m).
    pub position: f64,
    /// Armature velocity (m/s).
    pub velocity: f64,
}

impl Tolerance {
    /// Returns the default times `factor`; a small factor gives a converged reference.
    ///
    /// # Panics
    /// Panics if `factor` is not positive: no step is short enough for an error of zero.
    pub fn scaled(factor: f64) -> Self {
        assert!(factor > 0.0, "a tolerance factor is positive, not {factor}");
        let default = Self::default();
        Self {
            pressure: default.pressure * factor,
            current: default.current * factor,
            position: default.position * factor,
            velocity: default.velocity * factor,
        }
    }
}

impl Default for Tolerance {
    /// Returns tolerances with which the pressure stays within 0.2 mbar rms of a converged reference on a bench log;
    /// docs/evidence.md has the figures.
    fn default() -> Self {
        Self {
            pressure: 10.0,
            current: 1e-4,
            position: 1e-7,
            velocity: 1e-3,
        }
    }
}

/// Inverse of a tolerance.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    pressure: f64,
    /// Current, position, velocity.
    valve: [f64; 3],
}

impl Tolerance {
    pub(super) fn weights(&self) -> Weights {
        Weights {
            pressure: 1.0 / self.pressure,
            valve: [self.current, self.position, self.velocity].map(f64::recip),
        }
    }
}

impl Weights {
    /// Returns the largest local error of pressure and `M` valves in units of the tolerance; 1 is just allowed.
    #[inline]
    pub(super) fn measure<const N: usize, const M: usize>(&self, error: &[f64; N]) -> f64 {
        let valves = error[1..1 + 3 * M]
            .iter()
            .enumerate()
            .map(|(n, error)| error.abs() * self.valve[n % 3]);
        valves
            .fold(error[0].abs() * self.pressure, f64::max)
            .max(1e-6)
    }
}
