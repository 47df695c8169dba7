//! A plunger that enlarges the chamber (E53).

/// A plunger without mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plunger {
    /// Whole swept volume (m³).
    pub(crate) swept: f64,
    /// Pressure at which it leaves its stop (Pa abs).
    pub(crate) begin: f64,
    /// Pressure over the travel (Pa).
    pub(crate) travel: f64,
    /// Pressure that friction holds (Pa).
    pub(crate) friction: f64,
}

impl Plunger {
    /// Share of the travel (-) that a plunger without friction has at `pressure` (Pa abs).
    fn free(&self, pressure: f64) -> f64 {
        ((pressure - self.begin) / self.travel).clamp(0.0, 1.0)
    }

    /// Share of the travel (-) at `pressure` (Pa abs) after it was `last`: moved only by what exceeds the friction.
    pub(crate) fn share(&self, last: f64, pressure: f64) -> f64 {
        // No clamp: a stage of a step that is too long may have no pressure at all.
        last.max(self.free(pressure - self.friction))
            .min(self.free(pressure + self.friction))
    }

    /// Swept volume (m³) and its change with the pressure (m³/Pa), while the pressure rises or falls.
    pub(crate) fn volume(&self, last: f64, pressure: f64, rises: bool) -> (f64, f64) {
        let share = self.share(last, pressure);
        let pushed = if rises {
            self.free(pressure - self.friction) >= share
        } else {
            self.free(pressure + self.friction) <= share
        };
        let moves = pushed && share > 0.0 && share < 1.0;
        let slope = if moves { self.swept / self.travel } else { 0.0 };
        (self.swept * share, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plunger(friction: f64) -> Plunger {
        Plunger {
            swept: 1e-5,
            begin: 2e5,
            travel: 4e5,
            friction,
        }
    }

    #[test]
    fn friction_is_the_width_of_the_loop() {
        let plunger = plunger(0.1e5);
        let up = plunger.share(0.0, 4e5);
        assert!((up - 0.475).abs() < 1e-12);
        assert_eq!(plunger.share(up, 3.81e5), up, "still held");
        assert!((plunger.share(up, 3e5) - 0.275).abs() < 1e-12);
        assert_eq!(plunger.share(up, 9e5), 1.0);
    }
}
