//! Detector of the ECU's supply voltage.

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};

/// Debounce count N of the supply voltage (samples).
const BATTERY_N: u8 = Fault::BatteryLow.samples();

/// Window check of the supply voltage; a voltage that is not measured is not checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct BatteryDetector {
    low: Debounce,
    high: Debounce,
}

impl BatteryDetector {
    pub(crate) const NEW: Self = Self {
        low: Debounce::CLEAR,
        high: Debounce::CLEAR,
    };

    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, battery_mv: Option<u16>) {
        let Some(battery_mv) = battery_mv else { return };
        let n = limits.mechanisms.samples(BATTERY_N);
        self.low.update(battery_mv < limits.battery_min_mv, n);
        self.high.update(battery_mv > limits.battery_max_mv, n);
    }

    #[inline(always)]
    pub(crate) fn faults(&self) -> FaultSet {
        let low = FaultSet::when(self.low.is_confirmed(), Fault::BatteryLow);
        let high = FaultSet::when(self.high.is_confirmed(), Fault::BatteryHigh);
        low.union(high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::bench_limits;

    fn faults_after(
        detector: &mut BatteryDetector,
        millivolts: Option<u16>,
        samples: u8,
    ) -> FaultSet {
        for _ in 0..samples {
            detector.sample(&bench_limits(), millivolts);
        }
        detector.faults()
    }

    #[test]
    fn n_samples_outside_the_window_confirm_and_one_less_does_not() {
        for (millivolts, fault) in [
            (0, FaultSet::of(Fault::BatteryLow)),
            (15_999, FaultSet::of(Fault::BatteryLow)),
            (16_000, FaultSet::NONE),
            (24_000, FaultSet::NONE),
            (36_000, FaultSet::NONE),
            (36_001, FaultSet::of(Fault::BatteryHigh)),
            (u16::MAX, FaultSet::of(Fault::BatteryHigh)),
        ] {
            for (samples, expected) in [(9, FaultSet::NONE), (10, fault), (11, fault)] {
                let mut detector = BatteryDetector::NEW;
                let found = faults_after(&mut detector, Some(millivolts), samples);
                assert_eq!(found, expected, "{millivolts} mV, {samples}");
            }
        }
    }

    #[test]
    fn a_voltage_that_is_not_measured_is_not_judged() {
        let mut detector = BatteryDetector::NEW;
        assert_eq!(faults_after(&mut detector, Some(0), 9), FaultSet::NONE);
        assert_eq!(faults_after(&mut detector, None, 100), FaultSet::NONE);
        let low = FaultSet::of(Fault::BatteryLow);
        assert_eq!(faults_after(&mut detector, Some(0), 1), low);
        assert_eq!(faults_after(&mut detector, None, 100), low);
    }
}
