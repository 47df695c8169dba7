//! Anti-windup, section 6.5.1.

use crate::arithmetic::{clamp, wide_product};
use crate::control_signal::ControlSignal;
use crate::error::ConfigError;
use crate::integrator::Integrator;
use crate::pid::{Pid, sample_time};
use crate::range::{Range, propagate, quotient};
use crate::settings::{self, Settings};
use crate::table::Field;

/// Number of bits by which the integral part (2⁻⁵⁹) is finer than the product of u (2⁻²⁰) and T_s/T_t (2⁻³⁰).
const FINER: u32 = 59 - 20 - 30;

/// Anti-windup method: decides which integral part a sample leaves behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum AntiWindup {
    Off,
    ConditionalIntegration,
    BackCalculation,
}

impl AntiWindup {
    pub(crate) const fn of(settings: &Settings) -> Self {
        match settings.anti_windup {
            settings::AntiWindup::Off => Self::Off,
            settings::AntiWindup::ConditionalIntegration => Self::ConditionalIntegration,
            settings::AntiWindup::BackCalculation { .. } => Self::BackCalculation,
        }
    }

    /// Stores in `kept` the integral part for the next sample: `summed`, the unchanged `kept`, or `summed` reduced by a
    /// share of the cut-off part of u. Returns whether the error was summed without restriction.
    #[inline(always)]
    pub(crate) fn settle(
        self,
        tracking: Tracking,
        pid: &Pid,
        kept: &mut Integrator,
        summed: Integrator,
        u: i32,
    ) -> bool {
        match self {
            Self::ConditionalIntegration if is_driven(u) => false,
            Self::Off | Self::ConditionalIntegration => {
                *kept = summed;
                true
            }
            Self::BackCalculation => {
                let excess = cut_off(u);
                *kept = tracking.drawn(pid, summed, excess);
                excess == 0
            }
        }
    }
}

/// Returns whether u (100 %, 2⁻²⁰), counted along the error's direction, is saturated in that direction.
#[inline(always)]
pub(crate) const fn is_driven(u: i32) -> bool {
    u > ControlSignal::MAX.units()
}

/// Returns the part of u (100 %, 2⁻²⁰) that saturation cuts off.
#[inline(always)]
fn cut_off(u: i32) -> i32 {
    u.wrapping_sub(ControlSignal::from_units(u).saturated().units())
}

/// T_s/T_t, 2⁻³⁰, at most 1; 0 without back-calculation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Tracking(i32);

impl Tracking {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let settings::AntiWindup::BackCalculation { tracking_time_ms } = settings.anti_windup
        else {
            return Ok(Self(0));
        };
        let sample_time = propagate!(sample_time(settings)) as u128;
        // A tracking time shorter than the sample time would subtract more than was cut off.
        let range = Range::of(Field::TrackingTime).from(settings.sample_time_ms);
        let tracking_time =
            propagate!(range.checked(Field::TrackingTime, tracking_time_ms)) as u128;
        // The tracking time is at least the sample time: above 0, and the share at most 1.
        let share = quotient(
            (sample_time << 30).wrapping_add(tracking_time / 2),
            tracking_time,
        );
        Ok(Self(share as i32))
    }

    /// Returns the integral part reduced by T_s/T_t times the cut-off part of u, clamped to its bound.
    #[inline(always)]
    fn drawn(self, pid: &Pid, integral: Integrator, excess: i32) -> Integrator {
        // |excess| < 2³⁰ and the share at most 1: below 2⁶⁰, and the integral part at most 10 · 2⁵⁰.
        let sum = (integral.bits() >> FINER).wrapping_sub(wide_product(self.0, excess));
        let bound = (pid.integral_max() as i64) << (32 - FINER);
        Integrator::from_bits(clamp(sum, bound) << FINER)
    }
}
