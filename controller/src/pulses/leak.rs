//! Feed-forward of a lasting leak: the drift of the pressure while both valves are shut.

use crate::pressure::ERROR_SHIFT;
use crate::pulses::run::{Phase, Run};

/// log₂ of the low-pass filter's time constant (samples).
const FILTER_BITS: u32 = 6;
/// log₂ of the number of samples of drift by which a pulse leads the reference: between its start and the end of its flow.
const LEAD_BITS: u32 = 1;
/// log₂ of the number of samples of drift that a pulse gives in advance, so that the next one comes later, ...
const ADVANCE_BITS: u32 = 5;
/// ... less this share of the deadband, in eighths: the gas that cools after a step is no leak, ...
const DOUBTED_EIGHTHS: i32 = 2;
/// ... and at most this share: the rest is for the error of the landing.
const ADVANCE_EIGHTHS: i32 = 5;
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

    /// Returns the pressure by which the start of a pulse leads the reference (bar), 2⁻¹⁶.
    #[inline(always)]
    pub(super) const fn lead_of_start(&self) -> i32 {
        self.drift.wrapping_neg() >> (ERROR_SHIFT - LEAD_BITS)
    }

    /// Returns the pressure beyond the reference on which a pulse lands (bar), 2⁻¹⁶, with this deadband.
    #[inline(always)]
    pub(super) fn lead_of_landing(&self, deadband: i32) -> i32 {
        let share = |eighths: i32| deadband.wrapping_mul(eighths) >> 3;
        let drifted = self.drift.wrapping_neg() >> (ERROR_SHIFT - ADVANCE_BITS);
        let advance = drifted.wrapping_abs().wrapping_sub(share(DOUBTED_EIGHTHS));
        let advance = advance.max(0).min(share(ADVANCE_EIGHTHS));
        let advance = advance.wrapping_mul(drifted.signum());
        self.lead_of_start().wrapping_add(advance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the estimate after samples of a pressure that falls by this many units of 2⁻¹⁶ bar in each.
    fn leak_after(samples: i32, fall: i32, run: &Run) -> Leak {
        let mut leak = Leak::NONE;
        for sample in 0..samples {
            leak.sample(1 << 19, run, (3 << 16) - sample * fall);
        }
        leak
    }

    fn lead_after(samples: i32, fall: i32, run: &Run) -> i32 {
        leak_after(samples, fall, run).lead_of_start()
    }

    #[test]
    fn a_lasting_fall_is_led_by_two_samples_and_no_more_than_its_bound() {
        for (fall, expected) in [(0, 0), (100, 200), (-100, -200)] {
            let found = lead_after(1_000, fall, &Run::SHUT);
            assert!((found - expected).abs() <= 1, "{fall}: {found}");
        }
        // 2^19 units of 2^-25 bar are 1024 of 2^-16 bar.
        assert_eq!(lead_after(1_000, 3_000, &Run::SHUT), 2 * 1024);
        assert_eq!(lead_after(1_000, -3_000, &Run::SHUT), -2 * 1024);
    }

    /// With a leak, a pulse lands beyond the reference, so that the next one comes later; without one, on it.
    #[test]
    fn a_pulse_lands_beyond_the_reference_by_thirty_two_samples_of_a_leak_and_not_by_noise() {
        let deadband = 5_600;
        for (fall, advance) in [(0, 0), (40, 0), (100, 32 * 100 - 1_400), (200, 3_500)] {
            for sign in [1, -1] {
                let leak = leak_after(1_000, sign * fall, &Run::SHUT);
                let found = leak.lead_of_landing(deadband) - leak.lead_of_start();
                assert!((found - sign * advance).abs() <= 20, "{fall}: {found}");
            }
        }
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
            leak.lead_of_start()
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
