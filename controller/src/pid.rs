//! Discrete PID controller (equation 6.2).

use crate::arithmetic::{clamp, from_high_word, high_word, reload_barrier, wide_product};
use crate::error::{Coefficient, ConfigError};
use crate::integrator::{Bound, Integrator};
use crate::range::{CoefficientRange, Quotient, checked, hundredth, propagate};
use crate::settings::Settings;
use crate::table::Field;

/// Fraction bits of a gain (100 %/bar): its product with an error of 25 fraction bits has 52; the upper word of the
/// product is u with 20.
pub(crate) const GAIN_BITS: u32 = 27;
/// Fraction bits of K T_s/T_i (100 %/bar per sample): it is small and gets summed, so it uses all bits of a word.
const INTEGRAL_GAIN_BITS: u32 = 34;
/// Number of bits by which the upper word of the integral part is finer than u.
const INTEGRAL_SHIFT: u32 = INTEGRAL_GAIN_BITS - GAIN_BITS;

/// Below this range the rounding of the coefficient would be visible in u; above 12.5 the coefficient overflows its
/// word.
const INTEGRAL_GAIN: CoefficientRange = CoefficientRange::new("0.001", "7.9");
const DERIVATIVE_GAIN: CoefficientRange = CoefficientRange::new("0", "1000");

/// Coefficients of uₙ = K (eₙ + T_d (eₙ - eₙ₋₁)/T_s + T_s/T_i Σ eₖ).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Pid {
    /// K (100 %/bar), 2⁻²⁷.
    proportional: i32,
    /// K T_d/T_s (100 %/bar), 2⁻²⁷.
    derivative: i32,
    /// K T_s/T_i (100 %/bar per sample), 2⁻³⁴.
    integral: i32,
    /// Bound of the integral part (100 %), 2⁻²⁷.
    integral_max: Bound,
}

impl Pid {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let sample_time = propagate!(sample_time(settings));
        let gain = propagate!(checked(Field::Gain, settings.gain_pct_per_bar)) as u64;
        let integral = match settings.integral_time_ms {
            None => 0,
            Some(time) => {
                let time = propagate!(checked(Field::IntegralTime, time));
                // At most 2²⁶ · 2²⁶, in 2⁻³²; the divisor accounts for 16 of these bits.
                let quotient = Quotient {
                    coefficient: Coefficient::Integral,
                    numerator: gain.wrapping_mul(sample_time),
                    denominator: (time as u64) << 16,
                    range: INTEGRAL_GAIN,
                };
                propagate!(quotient.checked(INTEGRAL_GAIN_BITS))
            }
        };
        let derivative = match settings.derivative_time_ms {
            None => 0,
            Some(time) => {
                let time = propagate!(checked(Field::DerivativeTime, time));
                let quotient = Quotient {
                    coefficient: Coefficient::Derivative,
                    // At most 2²⁶ · 2³¹.
                    numerator: gain.wrapping_mul(time as u64),
                    denominator: sample_time << 16,
                    range: DERIVATIVE_GAIN,
                };
                propagate!(quotient.checked(GAIN_BITS))
            }
        };
        let integral_max = propagate!(checked(Field::IntegralMax, settings.integral_max_pct));
        Ok(Self {
            proportional: hundredth(gain, 1 << 16, GAIN_BITS),
            derivative,
            integral,
            integral_max: Bound::new(per_full_scale(integral_max, GAIN_BITS)),
        })
    }

    /// Returns K eₙ + K T_d (eₙ - eₙ₋₁)/T_s (100 %), 2⁻²⁰.
    #[inline(always)]
    pub(crate) const fn proportional_and_derivative(&self, error: i32, error_change: i32) -> i32 {
        high_word(
            wide_product(self.proportional, error)
                .wrapping_add(wide_product(self.derivative, error_change)),
        )
    }

    /// Returns K eₙ (100 %), 2⁻²⁰.
    #[inline(always)]
    pub(crate) const fn proportional(&self, error: i32) -> i32 {
        high_word(wide_product(self.proportional, error))
    }

    /// Returns K T_d (eₙ - eₙ₋₁)/T_s (100 %), 2⁻²⁰.
    #[inline(always)]
    pub(crate) const fn derivative(&self, error_change: i32) -> i32 {
        high_word(wide_product(self.derivative, error_change))
    }

    /// Returns the integral part plus this sample's error, clamped to its bound.
    #[inline(always)]
    pub(crate) fn integrated(&self, integral: Integrator, error: i32) -> Integrator {
        let summed = integral.advanced(wide_product(self.integral, error));
        reload_barrier();
        summed.clamp(self.integral_max)
    }

    /// Returns the integral part of u (100 %), 2⁻²⁰.
    #[inline(always)]
    pub(crate) const fn integral_part(integral: Integrator) -> i32 {
        integral.part() >> INTEGRAL_SHIFT
    }

    /// Returns the integral part before a sample with this error and without error change, such that the sample gives
    /// `u`; clamped to its bound.
    pub(crate) fn integral_that_gives(&self, u: i32, error: i32) -> Integrator {
        if self.integral == 0 {
            return Integrator::ZERO;
        }
        // |u| ≤ 1 and K e ≤ 320 are clamped to 13 times 100 %. That is more than the largest bound and the largest term
        // (0.079 · 32) together, and with 59 fraction bits it fits into 64.
        let rest = u.wrapping_sub(self.proportional(error)) as i64;
        let rest = clamp(rest, 13 << 20) << (59 - 20);
        let before = rest.wrapping_sub(wide_product(self.integral, error));
        Integrator::from_bits(clamp(before, from_high_word(self.integral_max.get())))
    }

    /// Returns the bound of the integral part (100 %), 2⁻²⁷.
    pub(crate) const fn integral_max(&self) -> i32 {
        self.integral_max.get()
    }
}

/// Converts a bound in percent (2⁻¹⁶) into a part of 100 % with `fraction_bits`, rounded down. At most 1000 % and 27
/// bits: 10 · 2²⁷.
pub(crate) const fn per_full_scale(bound: i32, fraction_bits: u32) -> i32 {
    (((bound as i64) << (fraction_bits - 16)) / 100) as i32
}

/// Returns the checked sample time (2⁻¹⁶ ms).
pub(crate) const fn sample_time(settings: &Settings) -> Result<u64, ConfigError> {
    let time = propagate!(checked(Field::SampleTime, settings.sample_time_ms));
    Ok(time as u64)
}
