//! Errors of the pressure sensors. All sensors of a rig are of one type and have the same errors.

/// Errors of a pressure sensor; by default none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensorErrors {
    /// Pressure that the sensor shows too much (Pa).
    pub offset_pa: f64,
    /// Pressure that is added to the offset while the sensor warms up (Pa).
    pub drift_pa: f64,
    /// Time constant of the warm-up, from the beginning (s); positive if there is a drift.
    pub warm_up_s: f64,
    /// Time constant of the first-order lag (s); 0 for none.
    pub lag_s: f64,
}

impl SensorErrors {
    /// Returns the rate of the lagged pressure (Pa/s) for a `pressure` at the port (Pa).
    pub(super) fn rate(&self, pressure: f64, lagged: f64) -> f64 {
        if self.lag_s > 0.0 {
            (pressure - lagged) / self.lag_s
        } else {
            0.0
        }
    }

    /// Returns the shown pressure (Pa abs) at a time (s), from the pressure at the port and its lagged value.
    pub(super) fn shown(&self, time_s: f64, pressure: f64, lagged: f64) -> f64 {
        let seen = if self.lag_s > 0.0 { lagged } else { pressure };
        let warm = if self.drift_pa == 0.0 {
            0.0
        } else {
            1.0 - (-time_s / self.warm_up_s).exp()
        };
        seen + self.offset_pa + self.drift_pa * warm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drift_reaches_63_percent_after_the_warm_up_time() {
        let sensor = SensorErrors {
            offset_pa: 100.0,
            drift_pa: 1000.0,
            warm_up_s: 20.0,
            lag_s: 0.0,
        };
        assert_eq!(sensor.shown(0.0, 2e5, 0.0), 200_100.0);
        assert!((sensor.shown(20.0, 2e5, 0.0) - 200_732.1).abs() < 0.1);
    }
}
