//! Range checks of settings; all of them also run at compile time.

use fixed::types::{I16F16, I32F32};

use crate::error::{Coefficient, ConfigError};
use crate::table::Field;

/// Propagates an error as `?` does, which constant functions do not have.
macro_rules! propagate {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(error) => return Err(error),
        }
    };
}
pub(crate) use propagate;

/// Allowed range of a field, ends included.
#[derive(Clone, Copy)]
pub(crate) struct Range {
    min: I16F16,
    max: I16F16,
}

impl Range {
    /// Returns the range of the table of settings.
    pub(crate) const fn of(field: Field) -> Self {
        let [min, max] = field.range();
        Self { min, max }
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

    /// Returns the bits of `value`, if it is in this range.
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

    /// Returns the bits of `value`, if it is in this range, whose lower end is the value of the field `other`.
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

    /// Returns the bits of `value`, if it is in this range, whose upper end is the value of the field `other`.
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

/// Returns the bits of `value`, if it is in the range of `field` in the table of settings.
pub(crate) const fn checked(field: Field, value: I16F16) -> Result<i32, ConfigError> {
    Range::of(field).checked(field, value)
}

/// Coefficient as the quotient of two integers, with the range that fits into the arithmetic.
pub(crate) struct Quotient {
    pub(crate) coefficient: Coefficient,
    pub(crate) numerator: u64,
    /// Divisor, above 0.
    pub(crate) denominator: u64,
    pub(crate) range: CoefficientRange,
}

/// Allowed range of a coefficient, ends included. It is a constant: the compiler parses the decimal text, not the target.
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
    /// Returns a hundredth of the quotient with `fraction_bits`, rounded to nearest, if the quotient is within its
    /// range. The division by 100 converts percent into a part of 100 %.
    ///
    /// `max`/100 · 2^`fraction_bits` is below 2³¹; the files of the coefficients give the reason.
    pub(crate) const fn checked(self, fraction_bits: u32) -> Result<i32, ConfigError> {
        let numerator = self.numerator as u128;
        let denominator = self.denominator as u128;
        // Below 2⁶¹: at most a gain of 2²⁶ times a time of 2³¹, divided by a time of at least 2¹² · 2¹⁶.
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

/// Returns a hundredth of a quotient with `fraction_bits`, rounded to nearest: percent become a part of 100 %.
///
/// The caller ensures that the result is below 2³¹.
pub(crate) const fn hundredth(numerator: u64, denominator: u64, fraction_bits: u32) -> i32 {
    let denominator = (denominator as u128).wrapping_mul(100);
    let rounded = ((numerator as u128) << fraction_bits).wrapping_add(denominator / 2);
    quotient(rounded, denominator) as i32
}

/// Returns the quotient, rounded down. No caller divides by 0. A division by 0 would give a quotient outside of every
/// range, not a panic.
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
        let range = Range::between(I16F16::lit("-0.5"), I16F16::lit("2.25"));
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
