//! A coil by its current.

use controller::Duty;

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};
use crate::history::History;

/// N \[PWM periods\], one in each sample.
pub(crate) const COIL_N: u8 = 3;
/// A coil is energised from this duty cycle on: 20 %, 2⁻¹⁶. Below, the current may end within each period.
pub(crate) const ENERGISED_MIN: i32 = 20 << 16;

/// One coil; a current that is not measured is not judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CoilDetector {
    energised: History,
    off: History,
    open: Debounce,
    short: Debounce,
}

impl CoilDetector {
    pub(crate) const NEW: Self = Self {
        energised: History::UNKNOWN,
        off: History::UNKNOWN,
        open: Debounce::CLEAR,
        short: Debounce::CLEAR,
    };

    /// Mean current over the last PWM period \[mA\].
    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, current_ma: Option<u16>) {
        let Some(current_ma) = current_ma else { return };
        let n = limits.mechanisms.samples(COIL_N);
        let takes_some = current_ma >= limits.coil_min_ma;
        let is_energised = self.energised.held_through(limits.settling);
        self.open.update(is_energised && !takes_some, n);
        let is_off = self.off.held_through(limits.settling);
        let takes_too_much = current_ma > limits.coil_max_ma;
        self.short.update(takes_too_much || is_off && takes_some, n);
    }

    /// The duty cycle that the coil just got.
    #[inline(always)]
    pub(crate) fn told(&mut self, duty: Duty) {
        self.energised.push(duty.to_bits() >= ENERGISED_MIN);
        self.off.push(duty.is_off());
    }

    #[inline(always)]
    pub(crate) fn faults(&self, open: Fault, short: Fault) -> FaultSet {
        FaultSet::when(self.open.is_confirmed(), open)
            .union(FaultSet::when(self.short.is_confirmed(), short))
    }
}
