//! Prior knowledge, for a fit of the plant, of a clock that the commands determine.
//!
//! Each change of a command admits a strip of phases and drifts, and all of them admit a polygon. In phase and drift it is oblique; in the
//! phases at the first and the last change it is nearly a rectangle, which a fit uses as its bounds.

use plant_sim::logger_clock::LoggerClock;

use super::Log;
use super::commands::{CommandClock, FITTED_SLACK, ends_s};
use crate::diagnosis::evidence::effect_unknown::EVEN_SD;
use crate::diagnosis::evidence::log::{KnownClock, KnownPhase};

/// Least standard deviation of a phase that the commands determine, over the time from row to row.
const PHASE_SD_MIN: f64 = 0.02;

/// Phases at the first and the last change of a command that clocks admit, as least and largest time relative to those of one clock (s).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Admitted([(f64, f64); 2]);

impl Admitted {
    /// Returns the phases that `admitting` admits, relative to those of `clock`.
    fn of(
        admitting: &CommandClock,
        clock: LoggerClock,
        middle_s: f64,
        ends_s: [f64; 2],
        sample_time_s: f64,
    ) -> Self {
        let apart_s = |at_s: f64| admitting.clock.phase_at_s(at_s) - clock.phase_at_s(at_s);
        // The same sample of the ECU for both.
        let whole_s = (apart_s(middle_s) / sample_time_s).round() * sample_time_s;
        Self(ends_s.map(|at_s| {
            let of_drift_s = admitting.drift_slack_ppm * 1e-6 * (at_s - middle_s).abs();
            let slack_s = admitting.phase_slack_s + of_drift_s;
            let apart_s = apart_s(at_s) - whole_s;
            (apart_s - slack_s, apart_s + slack_s)
        }))
    }

    /// Returns the union with all of `others` that overlap it, directly or through another one.
    fn joined(self, others: &[Self]) -> Self {
        let wider = others.iter().fold(self, |wider, other| {
            let pairs = || wider.0.into_iter().zip(other.0);
            let overlaps = pairs().all(|(one, other)| one.0 <= other.1 && other.0 <= one.1);
            let end = |n: usize| {
                let (one, other) = (wider.0[n], other.0[n]);
                (one.0.min(other.0), one.1.max(other.1))
            };
            if overlaps {
                Self([0, 1].map(end))
            } else {
                wider
            }
        });
        if wider == self {
            self
        } else {
            wider.joined(others)
        }
    }
}

/// Returns the range of clocks that the commands of `log` admit according to `from_commands`, around `clock`, which is one of them.
pub(super) fn known_clock(
    from_commands: &[CommandClock],
    clock: LoggerClock,
    log: &Log,
) -> KnownClock {
    let (interval_s, sample_time_s) = (log.command_interval_s, log.sample_time_s);
    let ends_s = ends_s(log.inputs(), sample_time_s);
    let phases = |one| Admitted::of(one, clock, log.middle_s(), ends_s, sample_time_s);
    let admitted: Vec<Admitted> = from_commands.iter().map(phases).collect();
    let Admitted(joined) = Admitted([(0.0, 0.0); 2]).joined(&admitted);
    KnownClock::Ends([0, 1].map(|end| {
        let (at_s, (least_s, most_s)) = (ends_s[end], joined[end]);
        let half_s = 0.5 * (most_s - least_s);
        KnownPhase {
            at_s,
            value_s: clock.phase_at_s(at_s) + least_s + half_s,
            sd_s: (EVEN_SD * half_s).max(PHASE_SD_MIN * interval_s),
            reach_s: half_s + FITTED_SLACK * interval_s,
        }
    }))
}

#[cfg(test)]
mod tests {
    use plant_sim::PlantParameters;

    use super::*;
    use crate::bench::logged_through;
    use crate::diagnosis::fit::gather::gather;

    /// Defect seen: two rows lie in each sample of the ECU, and every change is in the first of them, so that the commands admit a phase of
    /// 0 to 5 ms at both ends. A fit with three missing effects took 8 ms, and shifted the delay of the commands accordingly.
    #[test]
    fn rows_twice_as_fast_as_the_ecu_admit_half_a_sample_at_both_ends() {
        let pulses = [
            (0.07, 70.0, 0.0),
            (0.41, 0.0, 0.0),
            (0.09, 0.0, 70.0),
            (0.43, 0.0, 0.0),
        ];
        let clock = LoggerClock {
            phase_s: 1.2e-3,
            drift_ppm: 55.0,
        };
        let plant = PlantParameters::nominal();
        let log = logged_through(&plant, clock, 5e-3, 1, &pulses.repeat(40));
        let evidence = gather(&plant, [&log]).unwrap();
        let log = &evidence.logs[0];
        let KnownClock::Ends(ends) = log.known_clock else {
            panic!("the commands determine it");
        };
        for known in ends {
            let off_s = clock.phase_at_s(known.at_s) - known.value_s;
            let off_s = off_s - (off_s / log.sample_time_s).round() * log.sample_time_s;
            assert!(off_s.abs() < 2.5e-3, "{off_s}");
            assert!((2.5e-3..3.9e-3).contains(&known.reach_s), "{known:?}");
        }
    }
}
