//! Output of the pressure sensor.

use crate::additions::Additions;
use crate::hooks::{self, Now};

/// State of the sensor.
#[derive(Debug, Clone)]
pub(super) struct Sensor {
    /// Measured pressure (Pa abs): the chamber's or the cavity's.
    sensed: f64,
    /// Outputs of the stages of its lag (Pa abs).
    lagged: [f64; 2],
    /// Pressure behind lag and hysteresis (Pa abs).
    held: f64,
}

impl Sensor {
    pub(super) fn new(pressure: f64) -> Self {
        Self {
            sensed: pressure,
            lagged: [pressure; 2],
            held: pressure,
        }
    }

    /// Follows the pressure over `h` (s), from and to a value with its slope.
    #[inline]
    pub(super) fn follow(&mut self, additions: &Additions, h: f64, start: [f64; 2], end: [f64; 2]) {
        self.sensed = end[0];
        let mut through = self.sensed;
        if let Some(lag) = additions.sensor_lag {
            if h > 0.0 {
                self.lagged = lag.follow(self.lagged, h, start, end);
            }
            through = self.lagged[1];
        }
        let half = 0.5 * additions.sensor_hysteresis;
        self.held = self.held.clamp(through - half, through + half);
    }

    /// Moves all pressures by `shift` (Pa).
    pub(super) fn shift(&mut self, shift: f64) {
        self.sensed += shift;
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
