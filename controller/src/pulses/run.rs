//! Run of pulses: consecutive samples in which one valve is driven, until its flow has ended.

/// Valve of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) enum Valve {
    Fill,
    Vent,
}

/// Phase of a run.
///
/// ```text
/// Shut ──error beyond the deadband──► Driven ──last pulse──► UnderWay ──flow measured──► Shut
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) enum Phase {
    /// Both valves are shut, and all flow has been measured.
    Shut,
    /// Each pulse so far filled its period: the next one continues it.
    Driven,
    /// The last pulse was given; its flow is under way.
    UnderWay,
}

/// Pulses whose flow the pressure does not show completely.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Run {
    pub(super) phase: Phase,
    pub(super) valve: Valve,
    /// Whether the pressure after the run says something about the valve.
    pub(super) is_evidence: bool,
    /// Number of samples since the first pulse.
    pub(super) samples: i32,
    /// Number of full periods.
    pub(super) periods: i32,
    /// Open time that all pulses give together (µs).
    pub(super) open_us: i32,
    /// Pressure at the first pulse (bar gauge), 2⁻¹⁶.
    pub(super) start_pressure: i32,
    /// Error of the lag when the last pulse was chosen (µs).
    pub(super) lag_us: i32,
}

/// Number of samples after which a run counts as no longer. Only the difference of given and passed open time is used, and
/// a sample adds a period to both.
const SAMPLES_MAX: i32 = 100;

impl Run {
    /// No run.
    pub(super) const SHUT: Self = Self {
        phase: Phase::Shut,
        valve: Valve::Fill,
        is_evidence: true,
        samples: 0,
        periods: 0,
        open_us: 0,
        start_pressure: 0,
        lag_us: 0,
    };

    /// Returns a run that begins in this sample, of the fill valve or of the vent valve.
    #[inline(always)]
    pub(super) const fn beginning(is_fill: bool, pressure: i32) -> Self {
        Self {
            phase: Phase::Driven,
            valve: if is_fill { Valve::Fill } else { Valve::Vent },
            start_pressure: pressure,
            ..Self::SHUT
        }
    }

    /// Counts a sample.
    #[inline(always)]
    pub(super) const fn advance(&mut self, period_us: i32) {
        if matches!(self.phase, Phase::Driven) && self.samples == SAMPLES_MAX {
            self.is_evidence = false;
            self.periods = self.periods.wrapping_sub(1);
            self.open_us = self.open_us.wrapping_sub(period_us);
        } else if !matches!(self.phase, Phase::Shut) {
            self.samples = self.samples.wrapping_add(1);
        }
    }

    /// Ends the run without another pulse.
    #[inline(always)]
    pub(super) const fn end(&mut self) {
        self.phase = if self.periods == 0 {
            Phase::Shut
        } else {
            Phase::UnderWay
        };
    }

    /// Ends a run whose last pulse was not given.
    pub(super) const fn interrupt(&mut self) {
        self.is_evidence = false;
        if matches!(self.phase, Phase::Driven) {
            self.phase = Phase::UnderWay;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_endless_run_keeps_the_difference_of_given_and_passed_open_time() {
        let mut run = Run::beginning(false, 5);
        for _ in 0..300 {
            run.advance(10_000);
            run.periods += 1;
            run.open_us += 10_000;
        }
        assert_eq!((run.samples, run.periods), (100, 100));
        assert_eq!(run.open_us, 1_000_000);
        assert!(!run.is_evidence);
        assert_eq!((run.valve, run.start_pressure), (Valve::Vent, 5));
        run.phase = Phase::UnderWay;
        run.advance(10_000);
        assert_eq!((run.samples, run.open_us), (101, 1_000_000));
    }

    #[test]
    fn a_run_without_a_pulse_ends_at_once_and_another_one_with_its_flow() {
        for (periods, expected) in [(0, Phase::Shut), (1, Phase::UnderWay)] {
            let mut run = Run::beginning(true, 0);
            run.periods = periods;
            run.end();
            assert_eq!(run.phase, expected);
        }
    }

    #[test]
    fn no_run_gets_longer() {
        let mut run = Run::SHUT;
        run.advance(10_000);
        assert_eq!(run, Run::SHUT);
    }

    #[test]
    fn an_interrupted_run_is_no_evidence_and_gives_no_more_pulses() {
        for (phase, expected) in [
            (Phase::Shut, Phase::Shut),
            (Phase::Driven, Phase::UnderWay),
            (Phase::UnderWay, Phase::UnderWay),
        ] {
            let mut run = Run {
                phase,
                ..Run::beginning(true, 0)
            };
            run.interrupt();
            assert_eq!((run.phase, run.is_evidence), (expected, false));
        }
    }
}
