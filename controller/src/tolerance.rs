//! The tolerance that turns both valves off, section 6.3.1.

use crate::error::{ConfigError, Field};
use crate::pressure::ERROR_SHIFT;
use crate::range::{Range, propagate};
use crate::settings::Settings;

/// Half a unit of an input's error.
const HALF_UNIT: i32 = 1 << (ERROR_SHIFT - 1);
const TOLERANCE_BAR: Range = Range::new("0", "10");

/// P_tol \[bar\], 2⁻²⁵, less half of the 2⁻¹⁶ in which errors come: an error inside is then one that is smaller, and one on the edge
/// is neither. At least half a unit: then only e = 0 is inside, which is equation 6.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Tolerance(i32);

impl Tolerance {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let tolerance = propagate!(TOLERANCE_BAR.checked(Field::Tolerance, settings.tolerance_bar));
        let at_least_one = if tolerance == 0 { 1 } else { tolerance };
        Ok(Self((at_least_one << ERROR_SHIFT).wrapping_sub(HALF_UNIT)))
    }

    /// |e| < P_tol, strictly, as in figure 6.9.
    #[inline(always)]
    pub(crate) const fn holds(self, error: i32) -> bool {
        // From 0 to twice the tolerance, both ends excluded by the half unit.
        (error.wrapping_add(self.0) as u32) < (self.0 as u32) << 1
    }

    /// Whether an error counted along a direction is inside the tolerance or past it.
    #[inline(always)]
    pub(crate) const fn is_reached(self, error: i32) -> bool {
        error < self.0
    }
}
