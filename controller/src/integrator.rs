//! A bounded sum with a coefficient: the integral part and the boost are one each.

use crate::arithmetic::{from_high_word, high_word};

/// A part of the control signal that is summed over the samples — state. The owner gives the upper word its unit.
///
/// Every term that is added is an exact product, so the sum has no rounding error of its own, however long it runs.
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

    /// What the sum adds to the control signal, in units of its upper word.
    #[inline(always)]
    pub(crate) const fn part(self) -> i32 {
        high_word(self.0)
    }

    /// The same part, counted in the other direction.
    #[inline(always)]
    pub(crate) const fn turned(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    /// `term` more. The owner holds the sum at its bound, and so keeps it from leaving its words.
    #[inline(always)]
    pub(crate) const fn advanced(self, term: i64) -> Self {
        Self(self.0.wrapping_add(term))
    }

    /// The sum with its upper word held at the bound.
    ///
    /// The lower word goes on: it is less than one unit of the upper word, which is all that u sees.
    #[inline(always)]
    pub(crate) const fn held(self, bound: Bound) -> Self {
        let low = self.0 & 0xFFFF_FFFF;
        Self(from_high_word(bound.hold(high_word(self.0))).wrapping_add(low))
    }
}

/// The largest upper word that an [`Integrator`] may have; kept as its distance from the largest number, where a sum saturates by
/// itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Bound {
    headroom: i32,
}

impl Bound {
    /// A bound that is not negative, in units of the upper word.
    pub(crate) const fn new(bound: i32) -> Self {
        Self {
            headroom: i32::MAX.wrapping_sub(bound),
        }
    }

    pub(crate) const fn get(self) -> i32 {
        i32::MAX.wrapping_sub(self.headroom)
    }

    /// The smaller one of `high` and the bound: up to where it saturates, and back; one QADD and one SUB.
    #[inline(always)]
    const fn hold(self, high: i32) -> i32 {
        high.saturating_add(self.headroom)
            .wrapping_sub(self.headroom)
    }
}
