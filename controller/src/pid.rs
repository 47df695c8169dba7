//! The discrete PID controller, equation 6.2.

use crate::arithmetic::{from_high_word, wide_product};
use crate::control_signal::ControlSignal;
use crate::error::{Coefficient, ConfigError, Field};
use crate::integrator::Integrator;
use crate::range::{CoefficientRange, Quotient, Range, propagate};
use crate::settings::Settings;

/// How far an error (2⁻¹⁶ bar) is shifted up before it meets a gain, so that one word holds gains up to 1000.
pub(crate) const ERROR_SHIFT: u32 = 7;
/// Fraction bits of such a gain: with an error of 16 + 7 bits the product has 44, whose upper word is u with 12.
pub(crate) const GAIN_BITS: u32 = 44 - 16 - ERROR_SHIFT;
/// Fraction bits of K T_s/T_i, which meets the unshifted error: small, and summed, so it gets all that a word has.
const INTEGRAL_GAIN_BITS: u32 = 44 - 16;

const SAMPLE_TIME_MS: Range = Range::new("0.1", "1000");
const GAIN_PCT_PER_BAR: Range = Range::new("0.01", "1000");
const INTEGRAL_TIME_MS: Range = Range::new("1", "30000");
const DERIVATIVE_TIME_MS: Range = Range::new("0", "30000");
const INTEGRAL_MAX_PCT: Range = Range::new("0", "1000");
/// Below it the rounding of the coefficient would show in u; above 8 the word ends.
const INTEGRAL_GAIN: CoefficientRange = CoefficientRange::new("0.001", "7.9");
const DERIVATIVE_GAIN: CoefficientRange = CoefficientRange::new("0", "1000");

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
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let sample_time = propagate!(sample_time(settings));
        let gain =
            propagate!(GAIN_PCT_PER_BAR.checked(Field::Gain, settings.gain_pct_per_bar)) as u64;
        let integral = match settings.integral_time_ms {
            None => 0,
            Some(time) => {
                let time = propagate!(INTEGRAL_TIME_MS.checked(Field::IntegralTime, time));
                // At most 2²⁶ · 2²⁶, in 2⁻³²; the divisor takes 16 of these bits along.
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
                let time = propagate!(DERIVATIVE_TIME_MS.checked(Field::DerivativeTime, time));
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
        let integral_max =
            propagate!(INTEGRAL_MAX_PCT.checked(Field::IntegralMax, settings.integral_max_pct));
        Ok(Self {
            // K has 16 fraction bits and is at most 1000 < 2¹⁰: exact in 21.
            proportional: (gain << (GAIN_BITS - 16)) as i32,
            derivative,
            integral,
            integral_max: integral_max >> 4,
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
    pub(crate) const fn integrated(&self, integral: Integrator, error: i32) -> Integrator {
        integral.advanced(self.integral, error, self.integral_max)
    }

    /// The integral part before a sample of this error and no change, such that the sample gives `u`; within its bound.
    pub(crate) const fn integral_that_gives(&self, u: ControlSignal, error: i32) -> Integrator {
        if self.integral == 0 {
            return Integrator::ZERO;
        }
        // |u| ≤ 100 %, K e ≤ 32 000 %, one sample's sum ≤ 8 · 32 %, all in 2⁻⁴⁴ %: below 2⁶⁰.
        let rest = from_high_word(u.to_bits()).wrapping_sub(self.proportional(error));
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
pub(crate) const fn sample_time(settings: &Settings) -> Result<u64, ConfigError> {
    let time = propagate!(SAMPLE_TIME_MS.checked(Field::SampleTime, settings.sample_time_ms));
    Ok(time as u64)
}
