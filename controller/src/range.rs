//! The one way in which settings are checked; all of it also at compile time.

use fixed::types::{I16F16, I32F32};

use crate::error::{Coefficient, ConfigError, Field};

/// What `?` does, which constant functions do not have.
macro_rules! propagate {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(error) => return Err(error),
        }
    };
}
pub(crate) use propagate;

/// Where a field may be, ends included. Made as constants: the decimal text is read by the compiler, not by the target.
#[derive(Clone, Copy)]
pub(crate) struct Range {
    min: I16F16,
    max: I16F16,
}

impl Range {
    pub(crate) const PERCENT: Self = Self::new("0", "100");

    pub(crate) const fn new(min: &str, max: &str) -> Self {
        Self::between(I16F16::lit(min), I16F16::lit(max))
    }

    pub(crate) const fn between(min: I16F16, max: I16F16) -> Self {
        Self { min, max }
    }

    pub(crate) const fn from(self, min: I16F16) -> Self {
        Self { min, ..self }
    }

    pub(crate) const fn up_to(self, max: I16F16) -> Self {
        Self { max, ..self }
    }

    /// The bits of `value`, if it is in this range.
    pub(crate) const fn checked(self, field: Field, value: I16F16) -> Result<i32, ConfigError> {
        let Self { min, max } = self;
        let bits = value.to_bits();
        if bits < min.to_bits() || bits > max.to_bits() {
            Err(ConfigError::OutOfRange {
                field,
                value,
                min,
                max,
            })
        } else {
            Ok(bits)
        }
    }

    /// The bits of `value`, if it is in this range, whose lower end is the value of the field `other`.
    pub(crate) const fn checked_not_below(
        self,
        other: Field,
        field: Field,
        value: I16F16,
    ) -> Result<i32, ConfigError> {
        let Self { min, max } = self;
        if value.to_bits() < min.to_bits() {
            return Err(ConfigError::BelowOther {
                field,
                value,
                other,
                min,
                max,
            });
        }
        self.checked(field, value)
    }

    /// The bits of `value`, if it is in this range, whose upper end is the value of the field `other`.
    pub(crate) const fn checked_not_above(
        self,
        other: Field,
        field: Field,
        value: I16F16,
    ) -> Result<i32, ConfigError> {
        let Self { min, max } = self;
        if value.to_bits() > max.to_bits() {
            return Err(ConfigError::AboveOther {
                field,
                value,
                other,
                min,
                max,
            });
        }
        self.checked(field, value)
    }
}

/// A coefficient as the quotient of two whole numbers, with the range in which the arithmetic holds it.
pub(crate) struct Quotient {
    pub(crate) coefficient: Coefficient,
    pub(crate) numerator: u64,
    /// Above 0.
    pub(crate) denominator: u64,
    pub(crate) range: CoefficientRange,
}

/// Where a coefficient may be, ends included; a constant as [`Range`].
#[derive(Clone, Copy)]
pub(crate) struct CoefficientRange {
    min: I32F32,
    max: I32F32,
}

impl CoefficientRange {
    pub(crate) const fn new(min: &str, max: &str) -> Self {
        Self {
            min: I32F32::lit(min),
            max: I32F32::lit(max),
        }
    }
}

impl Quotient {
    /// The hundredth part of the quotient, as percent become a part of 100 %, with so many fraction bits, rounded to nearest, if
    /// the quotient is within its range.
    ///
    /// `max`/100 · 2^`fraction_bits` is below 2³¹; the coefficients' own files say why.
    pub(crate) const fn checked(self, fraction_bits: u32) -> Result<i32, ConfigError> {
        let numerator = self.numerator as u128;
        let denominator = self.denominator as u128;
        // Below 2⁶¹: at most a gain of 2²⁶ by a time of 2³¹, through a time of at least 2¹² · 2¹⁶.
        let bits = quotient((numerator << 32).wrapping_add(denominator / 2), denominator) as i64;
        let CoefficientRange { min, max } = self.range;
        if bits < min.to_bits() || bits > max.to_bits() {
            return Err(ConfigError::CoefficientOutOfRange {
                coefficient: self.coefficient,
                value: I32F32::from_bits(bits),
                min,
                max,
            });
        }
        Ok(hundredth(self.numerator, self.denominator, fraction_bits))
    }
}

/// The hundredth part of a quotient, as percent become a part of 100 %, with so many fraction bits, rounded to nearest.
///
/// The caller knows that it is below 2³¹.
pub(crate) const fn hundredth(numerator: u64, denominator: u64, fraction_bits: u32) -> i32 {
    let denominator = (denominator as u128).wrapping_mul(100);
    let rounded = ((numerator as u128) << fraction_bits).wrapping_add(denominator / 2);
    quotient(rounded, denominator) as i32
}

/// The quotient, rounded down. No caller divides by 0; if one did, the quotient would be out of every range, and not a panic.
pub(crate) const fn quotient(numerator: u128, denominator: u128) -> u128 {
    match numerator.checked_div(denominator) {
        Some(quotient) => quotient,
        None => u128::MAX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_holds_its_ends_and_nothing_beyond() {
        let range = Range::new("-0.5", "2.25");
        let checked = |bits| range.checked(Field::Gain, I16F16::from_bits(bits));
        for end in [-(1 << 15), 9 << 14] {
            assert_eq!(checked(end), Ok(end));
        }
        assert!(checked(-(1 << 15) - 1).is_err());
        assert!(checked((9 << 14) + 1).is_err());
    }

    #[test]
    fn a_coefficient_is_rounded_to_nearest_and_held_to_its_range() {
        let checked = |numerator, denominator| {
            let quotient = Quotient {
                coefficient: Coefficient::Integral,
                numerator,
                denominator,
                range: CoefficientRange::new("0.5", "200"),
            };
            quotient.checked(4)
        };
        // A hundredth of the quotient, in sixteenths.
        assert_eq!(checked(200, 1), Ok(32));
        assert_eq!(checked(2497, 20), Ok(20));
        assert_eq!(checked(2503, 20), Ok(20));
        assert_eq!(checked(1, 2), Ok(0));
        assert_eq!(checked(25, 8), Ok(1));
        assert_eq!(checked(24, 8), Ok(0));
        assert!(checked(49, 100).is_err());
        assert!(checked(201, 1).is_err());
    }

    #[test]
    fn a_quotient_by_zero_is_out_of_every_range_and_no_panic() {
        assert_eq!(quotient(7, 2), 3);
        assert_eq!(quotient(7, 0), u128::MAX);
    }
}
