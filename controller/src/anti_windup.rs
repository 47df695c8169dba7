//! Anti-windup, section 6.5.1.

use crate::arithmetic::wide_product;
use crate::error::{ConfigError, Field};
use crate::integrator::Integrator;
use crate::pid::{Pid, sample_time};
use crate::range::{Range, propagate, quotient};
use crate::settings::{self, Settings};

const TRACKING_TIME_MS: Range = Range::new("0.1", "30000");

/// Which integral part a sample leaves behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum AntiWindup {
    Off,
    ConditionalIntegration,
    BackCalculation {
        /// T_s/T_t, 2⁻³⁰, at most 1.
        share: i32,
    },
}

impl AntiWindup {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        Ok(match settings.anti_windup {
            settings::AntiWindup::Off => Self::Off,
            settings::AntiWindup::ConditionalIntegration => Self::ConditionalIntegration,
            settings::AntiWindup::BackCalculation { tracking_time_ms } => {
                let sample_time = propagate!(sample_time(settings)) as u128;
                // Faster than the sample time would take back more than was cut off.
                let range = TRACKING_TIME_MS.from(settings.sample_time_ms);
                let tracking_time =
                    propagate!(range.checked(Field::TrackingTime, tracking_time_ms)) as u128;
                // The tracking time is at least the sample time: above 0, and the share at most 1.
                Self::BackCalculation {
                    share: quotient(
                        (sample_time << 30).wrapping_add(tracking_time / 2),
                        tracking_time,
                    ) as i32,
                }
            }
        })
    }

    /// The integral part for the next sample: `before` this sample, `after` its error was summed, and what saturation cut
    /// off u (`excess` = u before - u after saturation, 2⁻¹² %); `driven` says that the error pushes further that way.
    #[inline(always)]
    pub(crate) fn settled(
        &self,
        pid: &Pid,
        before: Integrator,
        after: Integrator,
        excess: i32,
        driven: bool,
    ) -> Integrator {
        match self {
            Self::Off => after,
            Self::ConditionalIntegration => {
                if driven {
                    before
                } else {
                    after
                }
            }
            // |excess| < 2³⁰ and share ≤ 2³⁰: the product is below 2⁶⁰, with two more bits below 2⁶².
            Self::BackCalculation { share } => after.corrected(
                (wide_product(*share, excess) << 2).wrapping_neg(),
                pid.integral_max(),
            ),
        }
    }
}
