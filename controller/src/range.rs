//! The one way in which a setting is checked.

use fixed::types::{I16F16, I32F32};

use crate::error::{Coefficient, ConfigError, Field};

/// The value, if it is within `min ..= max`.
pub(crate) const fn checked(
    field: Field,
    value: I16F16,
    min: I16F16,
    max: I16F16,
) -> Result<I16F16, ConfigError> {
    if value.to_bits() < min.to_bits() || value.to_bits() > max.to_bits() {
        Err(ConfigError::OutOfRange {
            field,
            value,
            min,
            max,
        })
    } else {
        Ok(value)
    }
}

/// The coefficient of value `numerator` / `denominator` with `fraction_bits`, rounded to nearest, if it is within `min ..= max`.
///
/// The caller keeps `numerator` · 2^`fraction_bits` below 2⁶³ and `denominator` above 0 by the ranges of its fields.
pub(crate) fn checked_quotient(
    coefficient: Coefficient,
    numerator: u64,
    denominator: u64,
    fraction_bits: u32,
    min: I32F32,
    max: I32F32,
) -> Result<i32, ConfigError> {
    let wide = (u128::from(numerator) << 32) / u128::from(denominator.max(1));
    let value = I32F32::from_bits(i64::try_from(wide).unwrap_or(i64::MAX));
    if value < min || value > max {
        return Err(ConfigError::CoefficientOutOfRange {
            coefficient,
            value,
            min,
            max,
        });
    }
    let scaled = u128::from(numerator) << fraction_bits;
    let rounded = (scaled + u128::from(denominator.max(1) / 2)) / u128::from(denominator.max(1));
    Ok(i32::try_from(rounded).unwrap_or(i32::MAX))
}
