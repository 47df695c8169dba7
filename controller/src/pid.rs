//! The discrete PID controller, equation 6.2.

use fixed::types::{I16F16, I32F32};

use crate::arithmetic::{from_high_word, wide_product};
use crate::control_signal::ControlSignal;
use crate::error::{Coefficient, ConfigError, Field};
use crate::integrator::Integrator;
use crate::range::{checked, checked_quotient};
use crate::settings::Settings;

/// How far an error (2⁻¹⁶ bar) is shifted up before it meets K and K T_d/T_s, so that one word holds both gains up to 1000.
pub(crate) const ERROR_SHIFT: u32 = 7;
/// Fraction bits of K and K T_d/T_s: with an error of 16 + 7 bits the product has 44, whose upper word is u with 12.
pub(crate) const GAIN_BITS: u32 = 44 - 16 - ERROR_SHIFT;
/// Fraction bits of K T_s/T_i, which meets the unshifted error: small, and summed, so it gets what a word has.
const INTEGRAL_GAIN_BITS: u32 = 44 - 16;

/// uₙ = K (eₙ + T_d (eₙ - eₙ₋₁)/T_s + T_s/T_i Σ eₖ), multiplied out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Pid {
    /// K [%/bar], 2⁻²¹.
    proportional: i32,
    /// K T_d/T_s [%/bar], 2⁻²¹.
    derivative: i32,
    /// K T_s/T_i [%/bar per sample], 2⁻²⁸.
    integral: i32,
    /// Bound of the integral part [%], 2⁻¹².
    integral_max: i32,
}

impl Pid {
    pub(crate) fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let sample_time = sample_time(settings)?;
        let gain = bits(checked(
            Field::Gain,
            settings.gain_pct_per_bar,
            I16F16::lit("0.01"),
            I16F16::lit("1000"),
        )?);
        let integral = match settings.integral_time_ms {
            None => 0,
            Some(time) => {
                let time = bits(checked(
                    Field::IntegralTime,
                    time,
                    I16F16::ONE,
                    I16F16::lit("30000"),
                )?);
                // Below the range the rounding of the coefficient would show in u, above it the word ends.
                checked_quotient(
                    Coefficient::Integral,
                    // 2²⁶ · 2²⁶ units of 2⁻³²; divided by 2⁻¹⁶ leaves 16 bits.
                    gain * sample_time,
                    time << 16,
                    INTEGRAL_GAIN_BITS,
                    I32F32::lit("0.001"),
                    I32F32::lit("7.9"),
                )?
            }
        };
        let derivative = match settings.derivative_time_ms {
            None => 0,
            Some(time) => {
                let time = bits(checked(
                    Field::DerivativeTime,
                    time,
                    I16F16::ZERO,
                    I16F16::lit("30000"),
                )?);
                checked_quotient(
                    Coefficient::Derivative,
                    gain * time,
                    sample_time << 16,
                    GAIN_BITS,
                    I32F32::ZERO,
                    I32F32::lit("1000"),
                )?
            }
        };
        let integral_max = checked(
            Field::IntegralMax,
            settings.integral_max_pct,
            I16F16::ZERO,
            I16F16::lit("1000"),
        )?;
        Ok(Self {
            // K has 16 fraction bits and is at most 1000 < 2¹⁰: exact in 21.
            proportional: (gain << (GAIN_BITS - 16)) as i32,
            derivative,
            integral,
            integral_max: integral_max.to_bits() >> 4,
        })
    }

    /// K eₙ [%], 2⁻⁴⁴.
    #[inline(always)]
    pub(crate) const fn proportional(&self, error: i32) -> i64 {
        wide_product(self.proportional, error << ERROR_SHIFT)
    }

    /// K T_d (eₙ - eₙ₋₁)/T_s [%], 2⁻⁴⁴.
    #[inline(always)]
    pub(crate) const fn derivative(&self, change: i32) -> i64 {
        wide_product(self.derivative, change << ERROR_SHIFT)
    }

    /// The sum with this sample's error.
    #[inline(always)]
    pub(crate) fn integrated(&self, integral: Integrator, error: i32) -> Integrator {
        integral.advanced(self.integral, error, self.integral_max)
    }

    /// The integral part before a sample of this error and no change, such that the sample gives `u`; within its bound.
    pub(crate) fn integral_that_gives(&self, u: ControlSignal, error: i32) -> Integrator {
        if self.integral == 0 {
            return Integrator::ZERO;
        }
        // |u| ≤ 100 %, K e ≤ 32 000 %, one sample's sum ≤ 8 · 32 %, all in 2⁻⁴⁴ %: below 2⁶⁰.
        let rest = from_high_word(u.saturated().to_bits()).wrapping_sub(self.proportional(error));
        Integrator::ZERO.corrected(
            rest.wrapping_sub(wide_product(self.integral, error)),
            self.integral_max,
        )
    }

    /// Bound of the integral part [%], 2⁻¹².
    pub(crate) const fn integral_max(&self) -> i32 {
        self.integral_max
    }
}

/// The sample time [2⁻¹⁶ ms], checked.
pub(crate) fn sample_time(settings: &Settings) -> Result<u64, ConfigError> {
    let time = checked(
        Field::SampleTime,
        settings.sample_time_ms,
        I16F16::lit("0.1"),
        I16F16::lit("1000"),
    )?;
    Ok(bits(time))
}

/// The bits of a value that was checked not to be negative.
fn bits(value: I16F16) -> u64 {
    u64::from(value.to_bits().unsigned_abs())
}
