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
        let shown = quotient((numerator << 32).wrapping_add(denominator / 2), denominator);
        let bits = if shown > i64::MAX as u128 {
            i64::MAX
        } else {
            shown as i64
        };
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
