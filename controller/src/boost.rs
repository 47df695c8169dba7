//! The boost, section 6.5.3: an extra integrator that runs only while the pressure does not respond.

use fixed::types::{I16F16, I32F32};

use crate::error::{Coefficient, ConfigError, Field};
use crate::integrator::Integrator;
use crate::pid::{ERROR_SHIFT, GAIN_BITS, sample_time};
use crate::range::{checked, checked_quotient};
use crate::settings::Settings;

/// The extra integrator's coefficients; without boost it is never needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Boost {
    /// Rate times T_s [%/bar per sample], 2⁻²¹.
    rate: i32,
    /// Bound [%], 2⁻¹².
    max: i32,
    /// Smallest change of the pressure towards the reference in a sample that counts as response [bar], 2⁻¹⁶.
    response: i32,
}

impl Boost {
    pub(crate) fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let Some(boost) = settings.boost else {
            return Ok(Self {
                rate: 0,
                max: 0,
                response: 0,
            });
        };
        let rate = checked(
            Field::BoostRate,
            boost.rate_pct_per_bar_s,
            I16F16::ZERO,
            I16F16::lit("30000"),
        )?;
        let max = checked(
            Field::BoostMax,
            boost.max_pct,
            I16F16::ZERO,
            I16F16::lit("1000"),
        )?;
        let response = checked(
            Field::BoostResponse,
            boost.response_bar,
            I16F16::ZERO,
            I16F16::lit("10"),
        )?;
        let rate = checked_quotient(
            Coefficient::Boost,
            u64::from(rate.to_bits().unsigned_abs()) * sample_time(settings)?,
            // The rate is per second, the sample time in ms.
            1000 << 32,
            GAIN_BITS,
            I32F32::lit("0.1"),
            I32F32::lit("1000"),
        )?;
        Ok(Self {
            rate,
            max: max.to_bits() >> 4,
            response: response.to_bits(),
        })
    }

    /// Whether the pressure fails to move towards the reference.
    #[inline(always)]
    pub(crate) const fn is_needed(&self, error: i32, pressure_change: i32) -> bool {
        let towards_reference = if error < 0 {
            pressure_change.wrapping_neg()
        } else {
            pressure_change
        };
        towards_reference < self.response
    }

    /// One sample of boost more.
    #[inline(always)]
    pub(crate) fn advanced(&self, boost: Integrator, error: i32) -> Integrator {
        boost.advanced(self.rate, error << ERROR_SHIFT, self.max)
    }
}
