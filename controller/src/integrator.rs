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

    /// `term` more, which is not negative, while the upper word is held at `bound`.
    ///
    /// The lower word goes on: it is less than one unit of the upper word, which is all that u sees.
    #[inline(always)]
    pub(crate) const fn advanced(self, term: i64, bound: i32) -> Self {
        let sum = self.0.wrapping_add(term);
        let high = high_word(sum);
        let held = if high < bound { high } else { bound };
        Self(from_high_word(held) | (sum & 0xFFFF_FFFF))
    }
}
