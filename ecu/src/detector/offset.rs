//! A sensor that shows a pressure in an empty chamber.

use crate::config::Limits;
use crate::counted::counted;
use crate::fault::{Fault, FaultSet};
use crate::valve::Valves;

/// N \[samples\] with the vent valve open for sure: 2 s empty the largest chamber through the smallest orifice.
pub(crate) const OFFSET_N: u8 = 200;
/// An empty chamber shows no more: 0.2 bar gauge, 2⁻¹⁶. The highest ambient pressure is 0.07 bar above the standard one; the rest is
/// the sensor's error and noise.
pub(crate) const EMPTY_MAX: i32 = 13_107;

/// Drift that only a vented chamber shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct OffsetDetector {
    vented_for: u8,
    confirmed: bool,
}

impl OffsetDetector {
    pub(crate) const NEW: Self = Self {
        vented_for: 0,
        confirmed: false,
    };

    /// `pressure` \[bar\], 2⁻¹⁶; none is not judged.
    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, valves: &Valves, pressure: Option<i32>) {
        let Some(pressure) = pressure else { return };
        let settling = limits.settling;
        let is_vented = valves.vent.is_open(settling) && valves.fill.is_shut(settling);
        self.vented_for = counted(self.vented_for, is_vented && pressure > EMPTY_MAX);
        let n = limits.mechanisms.samples(OFFSET_N);
        self.confirmed = pressure > EMPTY_MAX && (self.confirmed || self.vented_for >= n);
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

    const VENTED: Output = Output {
        duty_fill: Duty::OFF,
        duty_vent: Duty::FULL,
    };

    /// A detector, and valves that were told this for long.
    fn settled(opening: Output) -> (OffsetDetector, Valves) {
        let mut valves = Valves::UNKNOWN;
        for _ in 0..40 {
            valves.told(&bench_limits(), opening);
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
