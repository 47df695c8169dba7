//! Output of the pressure sensor.

use crate::additions::Additions;
use crate::hooks::{self, Now};

/// State of the sensor.
#[derive(Debug, Clone)]
pub(super) struct Sensor {
    /// Outputs of the stages of its lag (Pa abs).
    lagged: [f64; 2],
    /// Pressure after lag and hysteresis (Pa abs).
    held: f64,
}

impl Sensor {
    pub(super) fn new(pressure: f64) -> Self {
        Self {
            lagged: [pressure; 2],
            held: pressure,
        }
    }

    /// Follows the pressure over `h` (s), from and to a value with its slope.
    pub(super) fn follow(&mut self, additions: &Additions, h: f64, start: [f64; 2], end: [f64; 2]) {
        if let Some(lag) = additions.sensor_lag
            && h > 0.0
        {
            self.lagged = lag.follow(self.lagged, h, start, end);
        }
        self.hold(additions, self.lagged[1]);
    }

    /// Follows the pressure to its present value without lag.
    #[inline]
    pub(super) fn follow_at_once(&mut self, additions: &Additions, pressure: f64) {
        self.hold(additions, pressure);
    }

    #[inline]
    fn hold(&mut self, additions: &Additions, through: f64) {
        let half = 0.5 * additions.sensor_hysteresis;
        self.held = self.held.clamp(through - half, through + half);
    }

    /// Moves all pressures by `shift` (Pa).
    pub(super) fn shift(&mut self, shift: f64) {
        self.lagged = self.lagged.map(|lagged| lagged + shift);
        self.held += shift;
    }

    /// Returns the shown pressure (Pa abs), `elapsed` (s) after the beginning.
    pub(super) fn shown(&self, additions: &Additions, now: &Now, elapsed: f64) -> f64 {
        let gauge = self.held - now.ambient_pressure;
        let drift = additions.sensor_drift;
        self.held
            + additions.sensor_offset
            + drift.map_or(0.0, |drift| drift.after(elapsed))
            + additions.sensor_gain * gauge
            + hooks::sum(&additions.hooks.measured, now)
    }
}
