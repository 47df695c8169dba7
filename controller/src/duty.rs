//! Duty cycle of a valve.

use core::fmt;

use fixed::types::I16F16;

/// Duty cycle of one valve (%), 0 ..= 100, 2⁻¹⁶ % (1.5 ns of a 10 ms PWM period) — output.
///
/// The unit is percent with a binary fraction, not a fraction of 2ⁿ. Therefore 0 and 100 % are exact, and so are the
/// thesis' limits (28.5, 54.5, 25.5, 51.5, 82, 80 %), which a fraction of full scale cannot represent. The field is
/// private and every constructor keeps the range, so a PWM can output every `Duty`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Duty(I16F16);

impl Duty {
    /// Never on: exactly 0 %.
    pub const OFF: Self = Self(I16F16::ZERO);
    /// Always on: exactly 100 %.
    pub const FULL: Self = Self(I16F16::lit("100"));

    /// Creates a duty cycle from percent; returns `None` outside 0 ..= 100 %.
    pub const fn from_percent(percent: I16F16) -> Option<Self> {
        let bits = percent.to_bits();
        if bits < 0 || bits > Self::FULL.to_bits() {
            None
        } else {
            Some(Self(percent))
        }
    }

    /// Returns the duty cycle in percent.
    pub const fn percent(self) -> I16F16 {
        self.0
    }

    /// Creates a duty cycle from units of 2⁻¹⁶ % that the distributor's arithmetic proves to be 0 ..= 100 %
    /// (docs/numerics.md).
    #[inline(always)]
    pub(crate) const fn from_proved_bits(bits: i32) -> Self {
        debug_assert!(
            bits >= 0 && bits <= Self::FULL.to_bits(),
            "the distributor left 0 ..= 100 %"
        );
        Self(I16F16::from_bits(bits))
    }

    /// Creates a duty cycle from units of 2⁻¹⁶ %, saturated at 0 and 100 %.
    #[must_use]
    #[inline]
    pub fn saturating_from_bits(bits: i32) -> Self {
        Self(I16F16::from_bits(bits.max(0).min(Self::FULL.to_bits())))
    }

    /// Returns 100 % minus the duty cycle.
    #[must_use]
    #[inline(always)]
    pub fn complement(self) -> Self {
        Self::saturating_from_bits(Self::FULL.to_bits().wrapping_sub(self.to_bits()))
    }

    /// Returns the duty cycle in units of 2⁻¹⁶ %; 100 % is 6 553 600.
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }

    /// Returns whether the valve is never on.
    pub const fn is_off(self) -> bool {
        self.0.to_bits() == 0
    }

    /// Returns the compare value of a PWM timer whose full scale is `counts_max`: the nearest count, exactly 0 at 0 %
    /// and exactly `counts_max` at 100 %.
    ///
    /// It costs one 64-bit multiplication and a division by a constant. Call it in the wiring, after the step.
    pub const fn to_counts(self, counts_max: u16) -> u16 {
        let full = Self::FULL.to_bits() as u64;
        // At most 2²³ · 2¹⁶ plus half of full scale, which fits into 64 bits; the quotient is at most counts_max.
        let scaled = (self.0.to_bits() as u64)
            .wrapping_mul(counts_max as u64)
            .wrapping_add(full / 2);
        (scaled / full) as u16
    }
}

impl fmt::Display for Duty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)?;
        f.write_str(" %")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distributor_may_go_to_both_ends() {
        assert_eq!(Duty::from_proved_bits(0), Duty::OFF);
        assert_eq!(Duty::from_proved_bits(Duty::FULL.to_bits()), Duty::FULL);
    }

    #[test]
    #[cfg(debug_assertions)]
    #[should_panic(expected = "the distributor left")]
    fn less_than_nothing_is_caught() {
        Duty::from_proved_bits(-1);
    }

    #[test]
    #[cfg(debug_assertions)]
    #[should_panic(expected = "the distributor left")]
    fn more_than_all_is_caught() {
        Duty::from_proved_bits(Duty::FULL.to_bits() + 1);
    }
}
