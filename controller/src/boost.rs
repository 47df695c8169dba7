//! Boost (section 6.5.3): an extra integrator that runs only while the pressure does not respond.

use crate::arithmetic::wide_product;
use crate::error::{Coefficient, ConfigError};
use crate::integrator::{Bound, Integrator};
use crate::pid::{GAIN_BITS, per_full_scale, sample_time};
use crate::pressure::ERROR_SHIFT;
use crate::range::{CoefficientRange, Quotient, checked, propagate};
use crate::settings::Settings;
use crate::table::Field;

/// Below this range the rounding of the coefficient would be visible in u; above it the coefficient overflows its word.
const RATE_PER_SAMPLE: CoefficientRange = CoefficientRange::new("0.1", "1000");

/// Coefficients of the extra integrator, which never runs if the boost is switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Boost {
    /// Smallest pressure change towards the reference in one sample (bar, 2⁻²⁵) that counts as a response.
    response: i32,
    /// Rate times T_s (100 %/bar per sample), 2⁻²⁷.
    rate: i32,
    /// Bound of the boost (100 %), 2⁻²⁰.
    max: Bound,
}

impl Boost {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let Some(boost) = settings.boost else {
            // No pressure change within the control range is below this response, so the boost never runs.
            return Ok(Self {
                response: -(1 << 30),
                rate: 0,
                max: Bound::new(0),
            });
        };
        let rate = propagate!(checked(Field::BoostRate, boost.rate_pct_per_bar_s)) as u64;
        let max = propagate!(checked(Field::BoostMax, boost.max_pct));
        let response = propagate!(checked(Field::BoostResponse, boost.response_bar));
        let quotient = Quotient {
            coefficient: Coefficient::Boost,
            // At most 2³¹ · 2²⁶, in 2⁻³²; the rate is per second, the sample time in ms.
            numerator: rate.wrapping_mul(propagate!(sample_time(settings))),
            denominator: 1000 << 32,
            range: RATE_PER_SAMPLE,
        };
        Ok(Self {
            response: response << ERROR_SHIFT,
            rate: propagate!(quotient.checked(GAIN_BITS)),
            max: Bound::new(per_full_scale(max, 20)),
        })
    }

    /// Returns the response minus this pressure change towards the reference (bar, 2⁻²⁵). The boost is needed if the
    /// result is above 0.
    #[inline(always)]
    pub(crate) const fn shortfall(&self, pressure_change: i32) -> i32 {
        // The response is from -2³⁰ to 2²⁹ and the change within ±2³⁰: the difference fits into a word.
        self.response.wrapping_sub(pressure_change)
    }

    /// Returns the boost of this sample: advanced by the error along its direction if `needed`, clamped to its bound.
    #[inline(always)]
    pub(crate) const fn advanced(&self, boost: Integrator, needed: bool, error: i32) -> Integrator {
        let summed = if needed {
            boost.advanced(wide_product(self.rate, error))
        } else {
            boost
        };
        summed.clamp(self.max)
    }
}
