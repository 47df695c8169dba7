//! The armature (equations 3.11 to 3.16): mass, spring, preload, viscous friction, pressure force, and
//! two perfectly inelastic end stops.

/// Armature parameters. Position x runs from 0 (unpowered end stop) to the stroke, in the direction of
/// the magnetic force.
#[derive(Debug, Clone, PartialEq)]
pub struct Armature {
    /// Mass (kg).
    pub mass: f64,
    /// Distance between the end stops (m).
    pub stroke: f64,
    /// Viscous friction (N s/m) (equation 3.14).
    pub viscous_friction: f64,
    /// Spring rate (N/m) (equation 3.15).
    pub spring_rate: f64,
    /// Spring preload at x = 0 (N) (equation 3.16).
    pub preload: f64,
    /// Area on which the pressure difference acts (m²) (equation 3.13); negative where the pressure
    /// acts against the magnet, as in a normally open valve.
    pub pressure_area: f64,
}

impl Armature {
    /// Returns the static force without the magnetic force (N), positive towards full stroke; `pressure_drop` is
    /// upstream minus downstream pressure (Pa).
    #[inline]
    pub fn static_force(&self, x: f64, pressure_drop: f64) -> f64 {
        self.pressure_area * pressure_drop - self.preload - self.spring_rate * x
    }

    /// Returns the acceleration (m/s²) under the magnet's force (equation 3.11).
    #[inline]
    pub fn acceleration(&self, magnetic_force: f64, x: f64, v: f64, pressure_drop: f64) -> f64 {
        (magnetic_force + self.static_force(x, pressure_drop) - self.viscous_friction * v)
            / self.mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_balance_as_in_equation_3_11() {
        let armature = Armature {
            mass: 5e-3,
            stroke: 0.5e-3,
            viscous_friction: 1.0,
            spring_rate: 2800.0,
            preload: 3.58,
            pressure_area: 2.776e-6,
        };
        let force = armature.static_force(0.5e-3, 8.4e5);
        assert!((force - (2.776e-6 * 8.4e5 - 3.58 - 1.4)).abs() < 1e-12);
        let acceleration = armature.acceleration(3.0, 0.5e-3, 0.2, 8.4e5);
        assert!((acceleration - (force + 3.0 - 0.2) / 5e-3).abs() < 1e-9);
    }
}
