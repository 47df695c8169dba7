//! Deadband: the tolerance within which both valves are off (section 6.3.1).

use crate::error::ConfigError;
use crate::pressure::ERROR_SHIFT;
use crate::range::{checked, propagate};
use crate::settings::Settings;
use crate::table::Field;

/// Half a unit of an input's error.
const HALF_UNIT: i32 = 1 << (ERROR_SHIFT - 1);

/// Deadband P_tol (bar), 2⁻²⁵, less half of the 2⁻¹⁶ bar in which errors come. With this half unit an error is inside
/// only if |e| is smaller than P_tol; |e| = P_tol is outside. The value is at least half a unit: then only e = 0 is
/// inside, which is equation 6.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Tolerance(i32);

impl Tolerance {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let tolerance = propagate!(checked(Field::Tolerance, settings.tolerance_bar));
        let at_least_one = if tolerance == 0 { 1 } else { tolerance };
        Ok(Self((at_least_one << ERROR_SHIFT).wrapping_sub(HALF_UNIT)))
    }

    /// Returns whether |e| < P_tol, strictly, as in figure 6.9.
    #[inline(always)]
    pub(crate) const fn holds(self, error: i32) -> bool {
        // From 0 to twice the deadband; the half unit excludes both ends.
        (error.wrapping_add(self.0) as u32) < (self.0 as u32) << 1
    }

    /// Returns whether an error counted along a direction is inside the deadband or beyond it.
    #[inline(always)]
    pub(crate) const fn is_reached(self, error: i32) -> bool {
        error < self.0
    }
}
