//! Simple pressure controller for logs that are recorded in closed loop.

use crate::chance::Chance;

/// Error within which both valves are off (bar).
const TOLERANCE: f64 = 0.1;
/// Duration of a sample (s).
const SAMPLE: f64 = 0.01;

/// Controller with proportional and integral action, for references that change now and then.
#[derive(Debug, Clone)]
pub(in crate::blind) struct ClosedLoop {
    /// Reference of each sample (bar gauge).
    references: Vec<f64>,
    grid: usize,
    /// Duty cycle at which a valve begins to respond (%).
    least_duty: f64,
    /// Duty cycle per error (%/bar) and per its integral (%/(bar s)).
    gains: [f64; 2],
    integral: f64,
    command: [f64; 2],
}

impl ClosedLoop {
    pub(super) fn new(samples: usize, grid: usize, chance: &mut Chance) -> Self {
        let mut references = vec![0.0; chance.whole(30, 80)];
        while references.len() < samples {
            let (from, to) = (references[references.len() - 1], chance.between(0.3, 7.5));
            let ramp = if chance.happens(0.3) {
                chance.whole(30, 150)
            } else {
                1
            };
            references.extend((1..=ramp).map(|n| from + (to - from) * n as f64 / ramp as f64));
            references.extend(std::iter::repeat_n(to, chance.whole(40, 250)));
        }
        Self {
            references,
            grid,
            least_duty: chance.between(32.0, 42.0),
            gains: [chance.between(8.0, 30.0), chance.between(5.0, 40.0)],
            integral: 0.0,
            command: [0.0; 2],
        }
    }

    /// Returns the duty cycles (%) of sample `n`, in which the ECU reads this pressure (bar gauge).
    pub(super) fn command(&mut self, n: usize, pressure: f64) -> [f64; 2] {
        let error = self.references[n] - pressure;
        if error.abs() < TOLERANCE {
            self.integral = 0.0;
        } else {
            self.integral += error * SAMPLE;
        }
        if n.is_multiple_of(self.grid) {
            let signal = self.gains[0] * error + self.gains[1] * self.integral;
            let duty = (self.least_duty + signal.abs()).min(100.0);
            let duty = (10.0 * duty).round() / 10.0;
            self.command = match signal {
                _ if error.abs() < TOLERANCE => [0.0; 2],
                signal if signal > 0.0 => [duty, 0.0],
                _ => [0.0, duty],
            };
        }
        self.command
    }
}
