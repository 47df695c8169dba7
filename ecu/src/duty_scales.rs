//! Factors of the duty limits in a sample.

use controller::{DutyScale, ReleaseShift};

/// Factors of the duty limits of both valves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DutyScales {
    pub(crate) fill: DutyScale,
    pub(crate) vent: DutyScale,
    /// Shift in place of the factor of a normally open vent valve.
    pub(crate) release: ReleaseShift,
}

impl DutyScales {
    pub(crate) const ONE: Self = Self {
        fill: DutyScale::ONE,
        vent: DutyScale::ONE,
        release: ReleaseShift::NONE,
    };

    /// Factor of a coil (U₀/U · R/R₀, 2⁻¹⁶) from which on the PID controller drives the valves, and not pulses: 1.48.
    ///
    /// Little above the current that opens it, a valve opens late and not fully, by scatter that no table knows. The
    /// integral part waits until the pressure moves. `docs/evidence.md` has the steps that are late with either one.
    const PULSES_MAX: u32 = 96_993;
    /// Factor up to which pulses begin again: 1.43.
    const PULSES_AGAIN: u32 = 93_716;

    /// Returns whether the currents of both coils are large enough for model-based pulses.
    #[inline(always)]
    pub(crate) const fn allow_pulses(&self, are_active: bool) -> bool {
        let limit = if are_active {
            Self::PULSES_MAX
        } else {
            Self::PULSES_AGAIN
        };
        self.fill.to_bits() < limit && self.vent.to_bits() < limit
    }
}
