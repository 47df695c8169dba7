//! What the pressure sensor shows.

use crate::additions::{Additions, lagged};
use crate::hooks::{self, Now};

/// The sensor's state.
#[derive(Debug, Clone)]
pub(super) struct Sensor {
    /// What it follows (Pa abs): the chamber's pressure or the cavity's.
    sensed: f64,
    /// What its lag lets through (Pa abs).
    lagged: f64,
}

impl Sensor {
    pub(super) fn new(pressure: f64) -> Self {
        Self {
            sensed: pressure,
            lagged: pressure,
        }
    }

    /// The pressure went on over `h` (s), from and to a value with its slope.
    #[inline]
    pub(super) fn follow(&mut self, time_constant: f64, h: f64, start: [f64; 2], end: [f64; 2]) {
        self.sensed = end[0];
        if time_constant > 0.0 && h > 0.0 {
            self.lagged = lagged(self.lagged, time_constant, h, start, end);
        }
    }

    /// All pressures are moved by `shift` (Pa).
    pub(super) fn shift(&mut self, shift: f64) {
        self.sensed += shift;
        self.lagged += shift;
    }

    /// What it shows (Pa abs).
    pub(super) fn shown(&self, additions: &Additions, now: &Now) -> f64 {
        let through = if additions.sensor_lag > 0.0 {
            self.lagged
        } else {
            self.sensed
        };
        let gauge = through - now.ambient_pressure;
        through
            + additions.sensor_offset
            + additions.sensor_gain * gauge
            + hooks::sum(&additions.hooks.measured, now)
    }
}
