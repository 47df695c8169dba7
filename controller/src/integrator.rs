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
    pub(crate) const fn advanced(self, coefficient: i32, input: i32, bound: i32) -> Self {
        self.corrected(wide_product(coefficient, input), bound)
    }

    /// `term` more [2⁻⁴⁴ %], held within ±`bound` (the upper word of a part, 2⁻¹² %).
    ///
    /// |self| < 2⁵⁴ and |term| ≤ 2⁶²: their sum is inside 64 bits.
    #[inline(always)]
    pub(crate) const fn corrected(self, term: i64, bound: i32) -> Self {
        let sum = self.0.wrapping_add(term);
        // The bound's lower word is zero, so the upper word alone tells.
        let high = (sum >> 32) as i32;
        let low_bound = bound.wrapping_neg();
        if high >= bound {
            Self(from_high_word(bound))
        } else if high < low_bound {
            Self(from_high_word(low_bound))
        } else {
            Self(sum)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the bound is met exactly, from either side. Method: one unit short of it, on it, one unit past it.
    #[test]
    fn only_what_is_beyond_the_bound_is_held_at_it() {
        let bound = 100 << 12;
        let limit = from_high_word(bound);
        for sign in [1, -1] {
            for (sum, expected) in [
                (limit - 1, limit - 1),
                (limit, limit),
                (limit + 1, limit),
                (1 << 62, limit),
            ] {
                let held = Integrator::ZERO.corrected(sign * sum, bound);
                assert_eq!(held.bits(), sign * expected, "{sign} * {sum}");
            }
        }
    }

    #[test]
    fn a_bound_of_zero_holds_zero() {
        for term in [-1, 0, 1] {
            assert_eq!(Integrator::ZERO.corrected(term, 0), Integrator::ZERO);
        }
    }
}
