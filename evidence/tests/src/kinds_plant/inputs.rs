//! Inputs of a rig from outside that a log shows: the motion of an actuator and the supply voltage.

use std::f64::consts::TAU;

/// Voltage (V) at which the delays of on/off valves are known.
pub const NOMINAL_V: f64 = 24.0;

/// Value over the time: a mean with two swings of different periods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// Mean.
    pub mean: f64,
    /// Amplitude of each swing.
    pub amplitudes: [f64; 2],
    /// Period of each swing (s).
    pub periods_s: [f64; 2],
}

impl Swing {
    /// Returns a value that does not swing.
    pub fn constant(mean: f64) -> Self {
        Self {
            mean,
            amplitudes: [0.0; 2],
            periods_s: [1.0; 2],
        }
    }

    /// Returns the value at a time (s).
    pub fn at(&self, time_s: f64) -> f64 {
        let swings = self.amplitudes.iter().zip(self.periods_s);
        let swings =
            swings.map(|(amplitude, period_s)| amplitude * (TAU * time_s / period_s).sin());
        self.mean + swings.sum::<f64>()
    }

    /// Returns the rate of change at a time (1/s).
    pub fn rate(&self, time_s: f64) -> f64 {
        let swings = self.amplitudes.iter().zip(self.periods_s);
        let rates = swings.map(|(amplitude, period_s)| {
            let frequency = TAU / period_s;
            amplitude * frequency * (frequency * time_s).cos()
        });
        rates.sum()
    }
}
