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
