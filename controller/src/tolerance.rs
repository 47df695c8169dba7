//! The tolerance that turns both valves off, section 6.3.1.

use fixed::types::I16F16;

use crate::error::{ConfigError, Field};
use crate::range::checked;
use crate::settings::Settings;

/// P_tol [bar], 2⁻¹⁶, at least one unit: then only e = 0 is inside, which is equation 6.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Tolerance(u32);

impl Tolerance {
    pub(crate) fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let tolerance = checked(
            Field::Tolerance,
            settings.tolerance_bar,
            I16F16::ZERO,
            I16F16::lit("10"),
        )?;
        Ok(Self(tolerance.to_bits().unsigned_abs().max(1)))
    }

    /// |e| < P_tol, strictly, as in figure 6.9.
    #[inline(always)]
    pub(crate) const fn holds(self, error: i32) -> bool {
        error.unsigned_abs() < self.0
    }
}
