//! The tolerance that turns both valves off, section 6.3.1.

use crate::error::{ConfigError, Field};
use crate::range::{Range, propagate};
use crate::settings::Settings;

const TOLERANCE_BAR: Range = Range::new("0", "10");

/// P_tol \[bar\], 2⁻¹⁶, at least one unit: then only e = 0 is inside, which is equation 6.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Tolerance(u32);

impl Tolerance {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let tolerance = propagate!(TOLERANCE_BAR.checked(Field::Tolerance, settings.tolerance_bar));
        Ok(Self(if tolerance == 0 {
            1
        } else {
            tolerance.unsigned_abs()
        }))
    }

    /// |e| < P_tol, strictly, as in figure 6.9.
    #[inline(always)]
    pub(crate) const fn holds(self, error: i32) -> bool {
        error.unsigned_abs() < self.0
    }
}
