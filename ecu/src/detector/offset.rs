//! Detector of a sensor that shows a pressure in an empty chamber.

use crate::config::Limits;
use crate::fault::{Fault, FaultSet};
use crate::valve::Valves;

/// Count N of a pressure in a vented chamber (samples with the vent valve certainly open): 2 s empty the largest
/// chamber through the smallest orifice.
const OFFSET_N: u8 = Fault::SensorOffset.samples();
/// Highest pressure reading of an empty chamber: 0.2 bar gauge, 2⁻¹⁶. The highest ambient pressure is 0.07 bar above
/// the standard one; the rest is the sensor's error and noise.
pub(crate) const EMPTY_MAX: i32 = 13_107;

/// Detector of drift that is visible only in a vented chamber.
///
/// Without an open vent valve there is no evidence: N such samples end the fault, so that the loop may try again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct OffsetDetector {
    /// Number of samples counted towards the confirmation, or left until the fault is over: 0 to N.
    evidence: u8,
    confirmed: bool,
}

impl OffsetDetector {
    pub(crate) const NEW: Self = Self {
        evidence: 0,
        confirmed: false,
    };

    /// Takes `pressure` (bar), 2⁻¹⁶; `None` is not checked.
    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, valves: &Valves, pressure: Option<i32>) {
        let Some(pressure) = pressure else { return };
        let settling = limits.settling;
        let is_vented = valves.vent.is_open(settling) && valves.fill.is_shut(settling);
        let n = limits.mechanisms.samples(OFFSET_N);
        self.evidence = if pressure <= EMPTY_MAX {
            0
        } else if is_vented {
            self.evidence.saturating_add(1).min(n)
        } else if self.confirmed {
            self.evidence.saturating_sub(1)
        } else {
            0
        };
        self.confirmed = self.evidence >= n || self.confirmed && self.evidence > 0;
    }

    #[inline(always)]
    pub(crate) fn faults(&self) -> FaultSet {
        FaultSet::when(self.confirmed, Fault::SensorOffset)
    }
}

#[cfg(test)]
mod tests {
    use controller::{Duty, Output};

    use super::*;
    use crate::detector::bench_limits;
    use crate::duty_scales::DutyScales;
    use crate::settings::VentValve;

    const VENTED: Output = Output {
        duty_fill: Duty::OFF,
        duty_vent: Duty::FULL,
    };

    /// Returns a detector, and valves that have had this command for a long time.
    fn settled(opening: Output) -> (OffsetDetector, Valves) {
        let mut valves = Valves::UNKNOWN;
        for _ in 0..40 {
            valves.record(
                bench_limits().open_duties(VentValve::NormallyClosed, DutyScales::ONE),
                opening,
            );
        }
        (OffsetDetector::NEW, valves)
    }

    fn faults_after(opening: Output, pressure: Option<i32>, samples: u8) -> FaultSet {
        let (mut detector, valves) = settled(opening);
        for _ in 0..samples {
            detector.sample(&bench_limits(), &valves, pressure);
        }
        detector.faults()
    }

    #[test]
    fn n_samples_of_pressure_in_a_vented_chamber_confirm_and_one_less_does_not() {
        let offset = FaultSet::of(Fault::SensorOffset);
        for (samples, expected) in [
            (199, FaultSet::NONE),
            (200, offset),
            (201, offset),
            (255, offset),
        ] {
            let found = faults_after(VENTED, Some(EMPTY_MAX + 1), samples);
            assert_eq!(found, expected, "{samples}");
        }
        assert_eq!(faults_after(VENTED, Some(EMPTY_MAX), 255), FaultSet::NONE);
    }

    #[test]
    fn a_chamber_that_is_not_vented_for_sure_may_have_pressure() {
        let both = Output {
            duty_fill: Duty::FULL,
            ..VENTED
        };
        for opening in [Output::OFF, both] {
            assert_eq!(faults_after(opening, Some(1 << 18), 255), FaultSet::NONE);
        }
    }

    #[test]
    fn without_evidence_it_is_over_after_n_samples_and_not_before() {
        let (mut detector, valves) = settled(VENTED);
        let (_, shut) = settled(Output::OFF);
        for _ in 0..210 {
            detector.sample(&bench_limits(), &valves, Some(1 << 16));
        }
        for sample in 1..=400 {
            detector.sample(&bench_limits(), &shut, Some(1 << 16));
            let expected = sample < 200;
            assert_eq!(
                detector.faults().contains(Fault::SensorOffset),
                expected,
                "{sample}"
            );
        }
    }

    #[test]
    fn the_samples_of_evidence_are_in_a_row_before_it_is_confirmed() {
        let (mut detector, valves) = settled(VENTED);
        let (_, shut) = settled(Output::OFF);
        for _ in 0..10 {
            for _ in 0..199 {
                detector.sample(&bench_limits(), &valves, Some(1 << 16));
            }
            detector.sample(&bench_limits(), &shut, Some(1 << 16));
            assert!(detector.faults().is_empty());
        }
    }

    #[test]
    fn it_stays_until_the_pressure_shows_an_empty_chamber() {
        let (mut detector, valves) = settled(VENTED);
        let (_, shut) = settled(Output::OFF);
        for _ in 0..200 {
            detector.sample(&bench_limits(), &valves, Some(1 << 16));
        }
        for (valves, pressure, expected) in [
            (&shut, Some(1 << 16), true),
            (&shut, None, true),
            (&valves, Some(EMPTY_MAX + 1), true),
            (&shut, Some(EMPTY_MAX), false),
            (&valves, Some(EMPTY_MAX + 1), false),
        ] {
            detector.sample(&bench_limits(), valves, pressure);
            let found = detector.faults().contains(Fault::SensorOffset);
            assert_eq!(found, expected, "{pressure:?}");
        }
    }
}
