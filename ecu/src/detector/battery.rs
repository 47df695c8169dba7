//! The supply voltage of the ECU.

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};

/// N \[samples\].
pub(crate) const BATTERY_N: u8 = 10;

/// A window; a voltage that is not measured is not judged.
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
