//! Pressure: what the controller is told.

use core::fmt;

use fixed::types::I16F16;

/// Pressure [bar gauge], -32768 ..< 32768, 2⁻¹⁶ bar (15 µbar) — input, reference and error.
///
/// A sensor of 10 bits over 10 bar resolves 10 mbar, one of 16 bits 0.15 mbar; both are coarser than this.
/// The controller itself works on [`Pressure::MIN_CONTROL`] ..= [`Pressure::MAX_CONTROL`] and saturates there.
///
/// A pressure and a duty cycle do not add:
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

/// log₂ of the control range in units of 2⁻¹⁶ bar. A power of two, so that a Cortex-M4 limits with one SSAT.
const CONTROL_RANGE_BITS: u32 = 20;

/// Bits by which a sample's pressures are finer than [`Pressure`]: so fine that products with gains keep u in their upper word.
pub(crate) const ERROR_SHIFT: u32 = 9;

impl Pressure {
    /// Ambient pressure, 0 bar gauge.
    pub const ZERO: Self = Self(I16F16::ZERO);
    /// Lowest pressure that the controller tells apart: -16 bar gauge. Below vacuum; a sensor's offset and noise stay unclipped.
    pub const MIN_CONTROL: Self = Self::from_bits(-(1 << CONTROL_RANGE_BITS));
    /// Highest pressure that the controller tells apart: 2⁻¹⁶ bar less than 16 bar gauge, about twice a truck's supply.
    pub const MAX_CONTROL: Self = Self::from_bits((1 << CONTROL_RANGE_BITS) - 1);

    /// From bar gauge.
    pub const fn from_bar(bar: I16F16) -> Self {
        Self(bar)
    }

    /// In bar gauge.
    pub const fn bar(self) -> I16F16 {
        self.0
    }

    /// From units of 2⁻¹⁶ bar.
    pub const fn from_bits(bits: i32) -> Self {
        Self(I16F16::from_bits(bits))
    }

    /// In units of 2⁻¹⁶ bar.
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }

    /// The sum, held at the ends of the type.
    #[must_use]
    pub const fn saturating_add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// The difference, held at the ends of the type.
    #[must_use]
    pub const fn saturating_sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// Held within [`Self::MIN_CONTROL`] ..= [`Self::MAX_CONTROL`].
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
