//! Clock of a logger relative to the clock of the ECU.
//!
//! The ECU samples and commands on its own grid, n T_ECU. A separate logger takes rows at other instants, and its clock
//! is fast or slow by some parts per million, so that its rows drift through the ECU's samples. A row shows the command
//! valid at its instant: the one that the ECU gave at its last sample before.

/// Number of ECU samples that [`LoggerClock::later`] leaves before the first row.
const SAMPLES_OF_ROOM: f64 = 3.0;

/// Clock of a logger relative to that of the ECU.
///
/// The row at `t` seconds after the first row of the log has the ECU time `phase_s + t (1 + drift_ppm 1e-6)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoggerClock {
    /// ECU time of the first row (s), since the ECU sample at or before it: 0 to T_ECU.
    pub phase_s: f64,
    /// Drift: excess of the ECU's time over the logger's time, per logged time (ppm).
    pub drift_ppm: f64,
}

impl LoggerClock {
    /// Returns the clock of `drift_ppm` that is `phase_s` later than the logger's count at `log_s` after the first row.
    pub fn with_phase_at(log_s: f64, phase_s: f64, drift_ppm: f64) -> Self {
        Self {
            phase_s: phase_s - log_s * drift_ppm * 1e-6,
            drift_ppm,
        }
    }

    /// Returns the clock some whole samples of the ECU later, so that no row is before the first sample of the ECU, as
    /// a row may be with a fast clock.
    pub fn later(self, sample_time_s: f64) -> Self {
        Self {
            phase_s: self.phase_s.rem_euclid(sample_time_s) + SAMPLES_OF_ROOM * sample_time_s,
            ..self
        }
    }

    /// Returns the difference (s) between the ECU time of an instant `log_s` after the first row and the logger's
    /// count.
    pub fn phase_at_s(&self, log_s: f64) -> f64 {
        self.phase_s + log_s * self.drift_ppm * 1e-6
    }

    /// Returns the ECU time (ns) of an instant `log_ns` after the first row of the log.
    pub fn ecu_time_ns(&self, log_ns: u64) -> u64 {
        let log_ns = log_ns as f64;
        (self.phase_s * 1e9 + log_ns + log_ns * self.drift_ppm * 1e-6)
            .round()
            .max(0.0) as u64
    }

    /// Returns the number of the ECU's sample, `sample_time_ns` apart, whose command a row shows for the first time.
    /// The row is `log_ns` after the first one, and rows are `interval_ns` apart.
    ///
    /// The sample is between the previous row and this one, on average half a row before it. The sample next to that
    /// instant is taken, which tolerates a slightly wrong clock.
    pub fn ecu_sample(&self, log_ns: u64, interval_ns: u64, sample_time_ns: u64) -> u64 {
        let mean_lag_ns = interval_ns.min(sample_time_ns) / 2;
        let given_ns = self.ecu_time_ns(log_ns).saturating_sub(mean_lag_ns);
        (given_ns + sample_time_ns / 2) / sample_time_ns.max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn a_row_shows_the_command_of_the_last_ecu_sample() {
        let clock = LoggerClock {
            phase_s: 7e-3,
            drift_ppm: 0.0,
        };
        let samples = [0, 4, 13].map(|ms| clock.ecu_sample(ms * MS, 2 * MS, 10 * MS));
        assert_eq!(samples, [1, 1, 2]);
    }

    #[test]
    fn a_slow_logger_falls_behind_by_its_drift() {
        let clock = LoggerClock {
            phase_s: 0.0,
            drift_ppm: 150.0,
        };
        assert_eq!(clock.ecu_time_ns(60_000 * MS), 60_009 * MS);
    }

    #[test]
    fn the_clock_of_the_ecu_changes_nothing_on_its_grid() {
        let clock = LoggerClock::default();
        assert_eq!(clock.ecu_time_ns(130 * MS), 130 * MS);
        assert_eq!(clock.ecu_sample(130 * MS, 10 * MS, 10 * MS), 13);
    }
}
