//! The boost, section 6.5.3: an extra integrator that runs only while the pressure does not respond.

use crate::error::{Coefficient, ConfigError, Field};
use crate::integrator::Integrator;
use crate::pid::{ERROR_SHIFT, GAIN_BITS, sample_time};
use crate::range::{CoefficientRange, Quotient, Range, propagate};
use crate::settings::Settings;

const RATE_PCT_PER_BAR_S: Range = Range::new("0.1", "30000");
const MAX_PCT: Range = Range::new("0", "1000");
const RESPONSE_BAR: Range = Range::new("0", "10");
/// Below it the rounding of the coefficient would show in u; above it the word ends.
const RATE_PER_SAMPLE: CoefficientRange = CoefficientRange::new("0.1", "1000");

/// The extra integrator's coefficients; without boost it is never needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Boost {
    /// Rate times T_s [%/bar per sample], 2⁻²¹.
    rate: i32,
    /// Bound [%], 2⁻¹².
    max: i32,
    /// Smallest change of the pressure towards the reference in a sample that counts as response \[bar\], 2⁻¹⁶.
    response: i32,
}

impl Boost {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let Some(boost) = settings.boost else {
            // No change is that negative: never needed.
            return Ok(Self {
                rate: 0,
                max: 0,
                response: i32::MIN,
            });
        };
        let rate =
            propagate!(RATE_PCT_PER_BAR_S.checked(Field::BoostRate, boost.rate_pct_per_bar_s))
                as u64;
        let max = propagate!(MAX_PCT.checked(Field::BoostMax, boost.max_pct));
        let response = propagate!(RESPONSE_BAR.checked(Field::BoostResponse, boost.response_bar));
        let quotient = Quotient {
            coefficient: Coefficient::Boost,
            // At most 2³¹ · 2²⁶, in 2⁻³²; the rate is per second, the sample time in ms.
            numerator: rate.wrapping_mul(propagate!(sample_time(settings))),
            denominator: 1000 << 32,
            range: RATE_PER_SAMPLE,
        };
        Ok(Self {
            rate: propagate!(quotient.checked(GAIN_BITS)),
            max: max >> 4,
            response,
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
    pub(crate) const fn advanced(&self, boost: Integrator, error: i32) -> Integrator {
        boost.advanced(self.rate, error << ERROR_SHIFT, self.max)
    }
}
