//! A sensor that shows the same code whatever the valves do.

use controller::{Output, Pressure};

use crate::config::Limits;
use crate::fault::{Fault, FaultSet};
use crate::sensor::SensorCode;

/// N \[samples\] in which a valve was driven.
pub(crate) const STUCK_N: u8 = 50;
/// Below this pressure a vent valve has little to move: 0.5 bar gauge, 2⁻¹⁶.
pub(crate) const ROOM_TO_FALL: i32 = 1 << 15;

/// Counts driven samples without a single changed bit.
///
/// A valve that stays shut looks the same but for the noise of the sensor, which changes a bit now and then. At rest nothing is
/// driven and nothing is counted: a sensor that is stuck at rest is not seen before the next command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct StuckDetector {
    code: SensorCode,
    unmoved: u8,
}

impl StuckDetector {
    pub(crate) const NEW: Self = Self {
        code: SensorCode::MIN,
        unmoved: 0,
    };

    /// `opening` is what the valves were told last, `pressure` that of the code.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        limits: &Limits,
        opening: Output,
        code: SensorCode,
        pressure: Pressure,
    ) {
        let is_filled = !opening.duty_fill.is_off() & (pressure.to_bits() < limits.supply_min);
        let is_vented = !opening.duty_vent.is_off() & (pressure.to_bits() > ROOM_TO_FALL);
        let is_driven = is_filled | is_vented;
        self.unmoved = if code == self.code {
            self.unmoved.saturating_add(is_driven.into())
        } else {
            0
        };
        self.code = code;
    }

    #[inline(always)]
    pub(crate) fn faults(&self, limits: &Limits) -> FaultSet {
        let n = limits.mechanisms.samples(STUCK_N);
        FaultSet::when(self.unmoved >= n, Fault::SensorStuck)
    }
}
