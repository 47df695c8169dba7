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
    pub(crate) fn sample(&mut self, limits: &Limits, battery_mv: Option<u16>, limit: u8) {
        let Some(battery_mv) = battery_mv else { return };
        self.low.update(battery_mv < limits.battery_min_mv, limit);
        self.high.update(battery_mv > limits.battery_max_mv, limit);
    }

    #[inline(always)]
    pub(crate) fn faults(&self, limit: u8) -> FaultSet {
        FaultSet::when(self.low.is_confirmed(limit), Fault::BatteryLow).union(FaultSet::when(
            self.high.is_confirmed(limit),
            Fault::BatteryHigh,
        ))
    }
}
