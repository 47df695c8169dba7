//! Plunger that enlarges the chamber (E53).

/// Plunger without mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plunger {
    /// Total swept volume (m³).
    pub(crate) swept: f64,
    /// Pressure at which the plunger leaves its stop (Pa abs).
    pub(crate) begin: f64,
    /// Pressure difference over the travel (Pa).
    pub(crate) travel: f64,
    /// Pressure equivalent of the friction (Pa).
    pub(crate) friction: f64,
    /// Time constant (s) of its damped motion; `None` if it follows at once.
    pub(crate) damping: Option<f64>,
}

/// Volume that follows the pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Volume {
    /// Size of the volume (m³).
    pub(crate) size: f64,
    /// Change of the volume with the pressure (m³/Pa).
    pub(crate) compliance: f64,
    /// Growth of the volume that is independent of the pressure rate (m³/s).
    pub(crate) growth: f64,
}

impl Volume {
    pub(crate) const NONE: Self = Self {
        size: 0.0,
        compliance: 0.0,
        growth: 0.0,
    };
}

impl Plunger {
    /// Returns the share of the travel (-) of a plunger without friction at `pressure` (Pa abs).
    fn free(&self, pressure: f64) -> f64 {
        ((pressure - self.begin) / self.travel).clamp(0.0, 1.0)
    }

    /// Returns the share of the travel (-) at `pressure` (Pa abs), given the previous share `last`: only a pressure
    /// beyond the friction moves the plunger.
    pub(crate) fn share(&self, last: f64, pressure: f64) -> f64 {
        // No clamp: in a stage of a step that is too long the pressure may be negative.
        last.max(self.free(pressure - self.friction))
            .min(self.free(pressure + self.friction))
    }

    /// Returns d(share)/dt (1/s) at `pressure` (Pa abs) of a damped plunger; 0 for one that follows at once.
    pub(crate) fn rate(&self, share: f64, pressure: f64) -> f64 {
        let pulled = self.share(share, pressure) - share;
        self.damping.map_or(0.0, |damping| pulled / damping)
    }

    /// Returns the share after a correction that moves the pressure, and the plunger with it, from `before` to
    /// `pressure` (Pa abs).
    pub(crate) fn shifted(&self, share: f64, before: f64, pressure: f64) -> f64 {
        if self.damping.is_some() {
            (share + self.free(pressure) - self.free(before)).clamp(0.0, 1.0)
        } else {
            self.share(share, pressure)
        }
    }

    /// Returns the swept volume while the pressure rises or falls, given the previous share `last` of the travel.
    pub(crate) fn volume(&self, last: f64, pressure: f64, rises: bool) -> Volume {
        if self.damping.is_some() {
            return Volume {
                size: self.swept * last,
                compliance: 0.0,
                growth: self.swept * self.rate(last, pressure),
            };
        }
        let share = self.share(last, pressure);
        let pushed = if rises {
            self.free(pressure - self.friction) >= share
        } else {
            self.free(pressure + self.friction) <= share
        };
        let moves = pushed && share > 0.0 && share < 1.0;
        Volume {
            size: self.swept * share,
            compliance: if moves { self.swept / self.travel } else { 0.0 },
            growth: 0.0,
        }
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
            damping: None,
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

    #[test]
    fn damping_lets_it_follow_what_exceeds_the_friction() {
        let plunger = Plunger {
            damping: Some(0.02),
            ..plunger(0.1e5)
        };
        assert!((plunger.rate(0.0, 4e5) - 0.475 / 0.02).abs() < 1e-9);
        assert_eq!(plunger.rate(0.475, 3.81e5), 0.0, "held");
        assert!((plunger.rate(0.475, 3e5) + 0.2 / 0.02).abs() < 1e-9);
        assert!((plunger.shifted(0.3, 3e5, 3.4e5) - 0.4).abs() < 1e-12);
    }
}
