//! Conditions of one log that are fitted: the clock of its logger and the gas with which it begins.

use plant_sim::logger_clock::LoggerClock;

use super::effect_unknown::EVEN_SD;
use super::log::{KnownClock, KnownPhase, Log};
use crate::conditions::Conditions;

/// Units of the clocks' coordinates (s and ppm), ...
const PHASE_UNIT_S: f64 = 1e-3;
const DRIFT_UNIT_PPM: f64 = 20.0;
/// ... and the range of a drift that only the model shows, around its initial value (ppm).
const DRIFT_REACH_PPM: f64 = 300.0;

/// Fitted condition of one log.
#[derive(Debug, Clone)]
pub(crate) struct LogUnknown {
    /// Index of the log.
    log: usize,
    figure: LogFigure,
    pub(crate) start: f64,
    /// Value and standard deviation that are known without the model; the deviation is infinite where nothing is known.
    pub(crate) known: (f64, f64),
    /// One unit of its coordinate.
    pub(crate) unit: f64,
    /// Least and largest value.
    pub(crate) range: (f64, f64),
}

/// Fitted quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
enum LogFigure {
    /// [`LoggerClock::phase_at_s`] one instant; the drift is unchanged.
    PhaseS { at_s: f64 },
    /// [`LoggerClock::drift_ppm`]; the phase at an instant is unchanged.
    DriftPpm { at_s: f64 },
    /// [`LoggerClock::phase_at_s`] one end of the log; the phase at the other end is unchanged.
    EndPhaseS { at_s: f64, other_s: f64 },
    /// [`StartGas::excess_k`](crate::conditions::StartGas::excess_k).
    StartExcessK,
    /// Logarithm of [`StartGas::cooling_s`](crate::conditions::StartGas::cooling_s).
    LnCoolingS,
}

impl LogUnknown {
    /// Returns the fitted conditions of log `index`: the clock if it has one, and the gas if the log begins with a filled chamber.
    pub(crate) fn of(index: usize, log: &Log) -> Vec<Self> {
        let clock = log.conditions.clock;
        let of_clock = clock.map_or_else(Vec::new, |clock| Self::of_clock(index, log, clock));
        let of_start = log.begins_filled().then(|| Self::of_start(index, log));
        of_clock
            .into_iter()
            .chain(of_start.into_iter().flatten())
            .collect()
    }

    fn of_clock(index: usize, log: &Log, clock: LoggerClock) -> Vec<Self> {
        let phase = |figure: LogFigure, known: KnownPhase| Self {
            log: index,
            figure,
            start: clock.phase_at_s(known.at_s),
            known: (known.value_s, known.sd_s),
            unit: PHASE_UNIT_S,
            range: (
                (known.value_s - known.reach_s).max(0.0),
                known.value_s + known.reach_s,
            ),
        };
        let in_middle = match log.known_clock {
            KnownClock::Ends([first, last]) => {
                return [(first, last.at_s), (last, first.at_s)]
                    .map(|(known, other_s)| {
                        let at_s = known.at_s;
                        phase(LogFigure::EndPhaseS { at_s, other_s }, known)
                    })
                    .to_vec();
            }
            KnownClock::Middle(known) => known,
            KnownClock::Nothing => KnownPhase {
                at_s: log.middle_s(),
                value_s: clock.phase_at_s(log.middle_s()),
                sd_s: f64::INFINITY,
                reach_s: 0.5 * log.sample_time_s,
            },
        };
        let (at_s, drift_ppm) = (in_middle.at_s, clock.drift_ppm);
        let drift = Self {
            log: index,
            figure: LogFigure::DriftPpm { at_s },
            start: drift_ppm,
            known: (drift_ppm, f64::INFINITY),
            unit: DRIFT_UNIT_PPM,
            range: (drift_ppm - DRIFT_REACH_PPM, drift_ppm + DRIFT_REACH_PPM),
        };
        vec![phase(LogFigure::PhaseS { at_s }, in_middle), drift]
    }

    fn of_start(index: usize, log: &Log) -> [Self; 2] {
        let gas = log.conditions.start_gas;
        let usual = log.usual_gas();
        let excess = Self {
            log: index,
            figure: LogFigure::StartExcessK,
            start: gas.excess_k,
            known: (0.0, usual.excess_sd_k),
            unit: usual.excess_sd_k,
            range: usual.excess_k,
        };
        let cooling = Self {
            log: index,
            figure: LogFigure::LnCoolingS,
            start: gas.cooling_s.ln(),
            known: (usual.usual_s.ln(), usual.ln_sd),
            unit: 1.0,
            range: (usual.least_s.ln(), usual.most_s.ln()),
        };
        [excess, cooling]
    }

    /// Sets `value` in the conditions of the logs.
    pub(crate) fn put(&self, conditions: &mut [Conditions], value: f64) {
        let there = &mut conditions[self.log];
        let clock = there.clock.unwrap_or_default();
        match self.figure {
            LogFigure::PhaseS { at_s } => {
                let moved = LoggerClock::with_phase_at(at_s, value, clock.drift_ppm);
                there.clock = Some(moved);
            }
            LogFigure::DriftPpm { at_s } => {
                let moved = LoggerClock::with_phase_at(at_s, clock.phase_at_s(at_s), value);
                there.clock = Some(moved);
            }
            LogFigure::EndPhaseS { at_s, other_s } => {
                let drift = (value - clock.phase_at_s(other_s)) / (at_s - other_s);
                there.clock = Some(LoggerClock::with_phase_at(at_s, value, 1e6 * drift));
            }
            LogFigure::StartExcessK => there.start_gas.excess_k = value,
            LogFigure::LnCoolingS => there.start_gas.cooling_s = value.exp(),
        }
    }

    /// Returns the largest distance of a fitted phase from the known one (s); none where it is no phase.
    pub(crate) fn phase_reach_s(&self) -> Option<f64> {
        let (least_s, most_s) = self.range;
        self.is_phase().then_some(0.5 * (most_s - least_s))
    }

    /// Lets a phase be further away from the known one, by up to `slack_s`.
    pub(crate) fn loosen_phase(&mut self, slack_s: f64) {
        if self.is_phase() {
            let (least_s, most_s) = self.range;
            self.range = ((least_s - slack_s).max(0.0), most_s + slack_s);
            self.known.1 = self.known.1.hypot(EVEN_SD * slack_s);
        }
    }

    /// Returns the name of the condition, for people.
    pub(crate) fn name(&self) -> &'static str {
        match self.is_of_clock() {
            true => "clock of the logger",
            false => "temperature of the gas at the start",
        }
    }

    /// Returns whether it is the phase at one end of a log, and `other` that at the other end.
    pub(crate) fn is_end_of_clock_with(&self, other: &Self) -> bool {
        let is_end = |figure| matches!(figure, LogFigure::EndPhaseS { .. });
        self.log == other.log && is_end(self.figure) && is_end(other.figure)
    }

    pub(crate) fn is_of_clock(&self) -> bool {
        self.is_phase() || matches!(self.figure, LogFigure::DriftPpm { .. })
    }

    fn is_phase(&self) -> bool {
        matches!(
            self.figure,
            LogFigure::PhaseS { .. } | LogFigure::EndPhaseS { .. }
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_at_two_ends_are_a_clock() {
        let clock = LoggerClock {
            phase_s: 32e-3,
            drift_ppm: -120.0,
        };
        let end = |at_s: f64, other_s: f64| LogUnknown {
            log: 0,
            figure: LogFigure::EndPhaseS { at_s, other_s },
            start: 0.0,
            known: (0.0, f64::INFINITY),
            unit: 1.0,
            range: (0.0, 1.0),
        };
        let mut conditions = [Conditions::default()];
        for (at_s, other_s) in [(1.0, 59.0), (59.0, 1.0)] {
            end(at_s, other_s).put(&mut conditions, clock.phase_at_s(at_s));
        }
        let found = conditions[0].clock.unwrap();
        assert!((found.phase_s - clock.phase_s).abs() < 1e-12, "{found:?}");
        assert!(
            (found.drift_ppm - clock.drift_ppm).abs() < 1e-6,
            "{found:?}"
        );
    }
}
