//! Anti-windup, section 6.5.1.

use fixed::types::I16F16;

use crate::arithmetic::wide_product;
use crate::error::{ConfigError, Field};
use crate::integrator::Integrator;
use crate::pid::{Pid, sample_time};
use crate::range::checked;
use crate::settings::{self, Settings};

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
    pub(crate) fn new(settings: &Settings) -> Result<Self, ConfigError> {
        Ok(match settings.anti_windup {
            settings::AntiWindup::Off => Self::Off,
            settings::AntiWindup::ConditionalIntegration => Self::ConditionalIntegration,
            settings::AntiWindup::BackCalculation { tracking_time_ms } => {
                let sample_time = sample_time(settings)?;
                // Faster than the sample time would overshoot what was cut off.
                let min = settings.sample_time_ms;
                let tracking_time = checked(
                    Field::TrackingTime,
                    tracking_time_ms,
                    min,
                    I16F16::lit("30000"),
                )?;
                let tracking_time = u64::from(tracking_time.to_bits().unsigned_abs()).max(1);
                Self::BackCalculation {
                    share: (((sample_time << 30) + tracking_time / 2) / tracking_time) as i32,
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
