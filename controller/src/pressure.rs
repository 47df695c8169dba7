//! Pressure: input of the controller.

use core::fmt;

use fixed::types::I16F16;

/// Pressure (bar gauge), -32768 ..< 32768, 2⁻¹⁶ bar (15 µbar) — input, reference and error.
///
/// A sensor of 10 bits over 10 bar resolves 10 mbar, one of 16 bits 0.15 mbar; both are coarser than this type. The
/// controller itself works on [`Pressure::MIN_CONTROL`] ..= [`Pressure::MAX_CONTROL`] and saturates there.
///
/// A pressure and a duty cycle cannot be added:
/// ```compile_fail,E0308
/// use controller::{Duty, Pressure};
/// let nonsense = Pressure::ZERO.saturating_add(Duty::FULL);
/// ```
/// ```compile_fail,E0369
/// use controller::{Duty, Pressure};
/// let nonsense = Pressure::ZERO + Duty::FULL;
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pressure(I16F16);

/// log₂ of the control range in units of 2⁻¹⁶ bar. The range is a power of two, so that a Cortex-M4 saturates with one
/// SSAT.
const CONTROL_RANGE_BITS: u32 = 20;

/// Number of bits by which a sample's pressures are finer than [`Pressure`]: with them the product with a gain has u in
/// its upper word.
pub(crate) const ERROR_SHIFT: u32 = 9;

impl Pressure {
    /// Ambient pressure, 0 bar gauge.
    pub const ZERO: Self = Self(I16F16::ZERO);
    /// Lowest pressure that the controller distinguishes: -16 bar gauge. It is below vacuum, so a sensor's offset and
    /// noise are not clipped.
    pub const MIN_CONTROL: Self = Self::from_bits(-(1 << CONTROL_RANGE_BITS));
    /// Highest pressure that the controller distinguishes: 2⁻¹⁶ bar less than 16 bar gauge, about twice a truck's
    /// supply pressure.
    pub const MAX_CONTROL: Self = Self::from_bits((1 << CONTROL_RANGE_BITS) - 1);

    /// Creates a pressure from bar gauge.
    pub const fn from_bar(bar: I16F16) -> Self {
        Self(bar)
    }

    /// Returns the pressure in bar gauge.
    pub const fn bar(self) -> I16F16 {
        self.0
    }

    /// Creates a pressure from units of 2⁻¹⁶ bar.
    pub const fn from_bits(bits: i32) -> Self {
        Self(I16F16::from_bits(bits))
    }

    /// Returns the pressure in units of 2⁻¹⁶ bar.
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }

    /// Returns the sum, saturated at the ends of the type.
    #[must_use]
    pub const fn saturating_add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// Returns the difference, saturated at the ends of the type.
    #[must_use]
    pub const fn saturating_sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// Returns the pressure saturated to [`Self::MIN_CONTROL`] ..= [`Self::MAX_CONTROL`].
    #[must_use]
    #[inline]
    pub fn saturated_to_control_range(self) -> Self {
        self.max(Self::MIN_CONTROL).min(Self::MAX_CONTROL)
    }
}

impl fmt::Display for Pressure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)?;
        f.write_str(" bar")
    }
}
