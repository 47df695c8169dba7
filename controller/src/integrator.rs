//! A bounded sum with a coefficient: the integral part and the boost are one each.

use crate::arithmetic::{from_high_word, high_word_towards_zero, wide_product};
use crate::control_signal::ControlSignal;

/// A part of the control signal that is summed over the samples [% of u], 2⁻⁴⁴ %, within ±[`Integrator::MAX`] — state.
///
/// Every term that is added is an exact product, so the sum has no rounding error of its own, however long it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Integrator(i64);

impl Integrator {
    pub(crate) const ZERO: Self = Self(0);
    /// The largest bound that settings can give: 1000 %.
    const MAX: i64 = from_high_word(1000 << 12);

    pub(crate) const fn checked_from_bits(bits: i64) -> Option<Self> {
        if bits < -Self::MAX || bits > Self::MAX {
            None
        } else {
            Some(Self(bits))
        }
    }

    pub(crate) const fn bits(self) -> i64 {
        self.0
    }

    /// What it adds to the control signal, for display.
    pub(crate) const fn part(self) -> ControlSignal {
        ControlSignal::from_bits(high_word_towards_zero(self.0))
    }

    /// One sample further: `coefficient` times `input` more, held within ±`bound` (the upper word of a part, 2⁻¹² %).
    #[inline(always)]
    pub(crate) fn advanced(self, coefficient: i32, input: i32, bound: i32) -> Self {
        // |self| < 2⁵⁴ and |product| ≤ 2⁶²: their sum is inside 64 bits.
        Self(self.0.wrapping_add(wide_product(coefficient, input))).bounded(bound)
    }

    /// `correction` (2⁻⁴⁴ %, at most 2⁶² in magnitude) more, held within ±`bound`.
    #[inline(always)]
    pub(crate) fn corrected(self, correction: i64, bound: i32) -> Self {
        Self(self.0.wrapping_add(correction)).bounded(bound)
    }

    #[inline(always)]
    fn bounded(self, bound: i32) -> Self {
        let limit = from_high_word(bound);
        Self(self.0.min(limit).max(limit.wrapping_neg()))
    }
}
