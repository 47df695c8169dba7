//! Feed-forward of a lasting leak: the drift of the pressure while both valves are shut.

use crate::pressure::ERROR_SHIFT;
use crate::pulses::run::{Phase, Run};

/// log₂ of the low-pass filter's time constant (samples).
const FILTER_BITS: u32 = 6;
/// log₂ of the number of samples of drift by which a pulse leads the reference.
const LEAD_BITS: u32 = 3;
/// Number of samples without flow after which a change of pressure is a drift.
const QUIET: u8 = 3;
/// Largest change of the pressure that counts as drift (bar), 2⁻¹⁶: 0.25 bar.
const CHANGE_MAX: i32 = 1 << 14;
/// Change of the pressure in a sample that counts as motion (bar), 2⁻¹⁶: 25 mbar, four times the noise of a change.
const MOVING: i32 = 1_638;

/// Estimate of the drift.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Leak {
    /// Drift (bar per sample), 2⁻²⁵.
    drift: i32,
    /// Pressure of the last sample (bar gauge), 2⁻¹⁶.
    pressure: i32,
    /// Number of samples without flow, at most [`QUIET`].
    quiet: u8,
}

impl Leak {
    /// No leak.
    pub(super) const NONE: Self = Self {
        drift: 0,
        pressure: 0,
        quiet: 0,
    };

    /// Takes the pressure of a sample (bar gauge, 2⁻¹⁶), and returns whether it moved. The drift is frozen while a run is
    /// driven or under way.
    #[inline(always)]
    pub(super) fn sample(&mut self, drift_max: i32, run: &Run, pressure: i32) -> bool {
        let change = pressure.wrapping_sub(self.pressure);
        self.pressure = pressure;
        if run.phase != Phase::Shut {
            self.quiet = 0;
        } else if self.quiet < QUIET {
            self.quiet = self.quiet.wrapping_add(1);
        } else {
            let change = change.clamp(-CHANGE_MAX, CHANGE_MAX) << ERROR_SHIFT;
            let step = change.wrapping_sub(self.drift) >> FILTER_BITS;
            let drift = self.drift.wrapping_add(step);
            self.drift = drift.max(drift_max.wrapping_neg()).min(drift_max);
        }
        // Two pressures of the control range differ by less than 2²² units.
        change.wrapping_abs() > MOVING
    }

    /// Returns the pressure by which a pulse has to lead the reference (bar), 2⁻¹⁶.
    #[inline(always)]
    pub(super) const fn lead(&self) -> i32 {
        self.drift.wrapping_neg() >> (ERROR_SHIFT - LEAD_BITS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the lead after samples of a pressure that falls by this many units of 2⁻¹⁶ bar in each.
    fn lead_after(samples: i32, fall: i32, run: &Run) -> i32 {
        let mut leak = Leak::NONE;
        for sample in 0..samples {
            leak.sample(1 << 19, run, (3 << 16) - sample * fall);
        }
        leak.lead()
    }

    #[test]
    fn a_lasting_fall_is_led_by_eight_samples_and_no_more_than_its_bound() {
        for (fall, expected) in [(0, 0), (100, 800), (-100, -800)] {
            let found = lead_after(1_000, fall, &Run::SHUT);
            assert!((found - expected).abs() <= 3, "{fall}: {found}");
        }
        // 2^19 units of 2^-25 bar are 1024 of 2^-16 bar.
        assert_eq!(lead_after(1_000, 3_000, &Run::SHUT), 8 * 1024);
        assert_eq!(lead_after(1_000, -3_000, &Run::SHUT), -8 * 1024);
    }

    #[test]
    fn the_drift_is_frozen_while_a_run_is_under_way_and_just_after_it() {
        let driven = Run::beginning(true, 0);
        assert_eq!(lead_after(1_000, 100, &driven), 0);
        assert_eq!(lead_after(3, 100, &Run::SHUT), 0);
        assert!(lead_after(4, 100, &Run::SHUT) > 0);
    }

    #[test]
    fn a_jump_counts_with_a_quarter_of_a_bar() {
        let after = |jump: i32| {
            let mut leak = Leak::NONE;
            for pressure in [0, 0, 0, 0, jump] {
                leak.sample(1 << 22, &Run::SHUT, pressure);
            }
            leak.lead()
        };
        assert_eq!(after(1 << 20), after(CHANGE_MAX));
        assert_eq!(after(-(1 << 20)), after(-CHANGE_MAX));
        assert!(after(CHANGE_MAX - 64) > after(CHANGE_MAX));
    }

    #[test]
    fn noise_is_no_motion_and_more_than_25_millibar_is() {
        let mut leak = Leak::NONE;
        for (pressure, expected) in [
            (MOVING, false),
            (2 * MOVING + 1, true),
            (0, true),
            (-1, false),
        ] {
            assert_eq!(leak.sample(0, &Run::SHUT, pressure), expected, "{pressure}");
        }
    }
}
