//! Bounded integrator, used by the integral part and by the boost.

use crate::arithmetic::{from_high_word, high_word};

/// Part of the control signal that is summed over the samples — state. The owner defines the unit of the upper word.
///
/// Every added term is an exact product, so the sum has no rounding error of its own, after any number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Integrator(i64);

impl Integrator {
    pub(crate) const ZERO: Self = Self(0);

    pub(crate) const fn from_bits(bits: i64) -> Self {
        Self(bits)
    }

    pub(crate) const fn bits(self) -> i64 {
        self.0
    }

    /// Returns the contribution to the control signal, in units of the upper word.
    #[inline(always)]
    pub(crate) const fn part(self) -> i32 {
        high_word(self.0)
    }

    /// Returns the same sum, counted in the other direction.
    #[inline(always)]
    pub(crate) const fn negated(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    /// Returns the sum plus `term`. The owner clamps the sum to its bound, so it cannot overflow.
    #[inline(always)]
    pub(crate) const fn advanced(self, term: i64) -> Self {
        Self(self.0.wrapping_add(term))
    }

    /// Returns the sum with its upper word clamped to the bound.
    ///
    /// The lower word is not clamped: it is less than one unit of the upper word, and u uses only the upper word.
    #[inline(always)]
    pub(crate) const fn clamp(self, bound: Bound) -> Self {
        let low = self.0 & 0xFFFF_FFFF;
        Self(from_high_word(bound.hold(high_word(self.0))).wrapping_add(low))
    }
}

/// Largest upper word of an [`Integrator`], stored as its distance from `i32::MAX`, where an addition saturates by
/// itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Bound {
    headroom: i32,
}

impl Bound {
    /// Creates a bound from a number that is not negative, in units of the upper word.
    pub(crate) const fn new(bound: i32) -> Self {
        Self {
            headroom: i32::MAX.wrapping_sub(bound),
        }
    }

    pub(crate) const fn get(self) -> i32 {
        i32::MAX.wrapping_sub(self.headroom)
    }

    /// Returns the smaller of `high` and the bound, by a saturating addition and a subtraction; one QADD and one SUB.
    #[inline(always)]
    const fn hold(self, high: i32) -> i32 {
        high.saturating_add(self.headroom)
            .wrapping_sub(self.headroom)
    }
}
