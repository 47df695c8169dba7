//! Errors of settings and of a saved state.

use core::fmt;

use fixed::types::{I16F16, I32F32};

use crate::table::Field;

/// Reason why [`Settings`](crate::Settings) give no configuration: the field, its value and the violated bound.
///
/// No controller can run with such settings: correct the named field and build again. The first wrong field in the
/// order of the fields is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConfigError {
    /// A field outside its own range.
    #[error("{field} = {value} {unit} is out of range: must be {min} ..= {max} {unit}", unit = field.unit())]
    OutOfRange {
        /// Rejected field.
        field: Field,
        /// Value of the field.
        value: I16F16,
        /// Smallest allowed value.
        min: I16F16,
        /// Largest allowed value.
        max: I16F16,
    },
    /// A field below another field that bounds it.
    #[error("{field} = {value} {unit} is below {other} = {min} {unit}: must be {min} ..= {max} {unit}", unit = field.unit())]
    BelowOther {
        /// Rejected field.
        field: Field,
        /// Value of the field.
        value: I16F16,
        /// Field that gives the lower bound.
        other: Field,
        /// Value of that field: the smallest allowed value.
        min: I16F16,
        /// Largest allowed value.
        max: I16F16,
    },
    /// A field above another field that bounds it.
    #[error("{field} = {value} {unit} is above {other} = {max} {unit}: must be {min} ..= {max} {unit}", unit = field.unit())]
    AboveOther {
        /// Rejected field.
        field: Field,
        /// Value of the field.
        value: I16F16,
        /// Field that gives the upper bound.
        other: Field,
        /// Smallest allowed value.
        min: I16F16,
        /// Value of that field: the largest allowed value.
        max: I16F16,
    },
    /// Coefficient beyond the range of the arithmetic, computed from fields that are each within their own range.
    #[error(
        "{coefficient} = {value} {unit} is out of range: must be {min} ..= {max} {unit}",
        unit = coefficient.unit()
    )]
    CoefficientOutOfRange {
        /// Rejected product of fields.
        coefficient: Coefficient,
        /// Value of the coefficient.
        value: I32F32,
        /// Smallest allowed value.
        min: I32F32,
        /// Largest allowed value.
        max: I32F32,
    },
}

/// Product of settings that has to fit into the arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Coefficient {
    /// K T_s / T_i: contribution to u of one bar of error in one sample.
    Integral,
    /// K T_d / T_s: contribution to u of one bar of error change in one sample.
    Derivative,
    /// Boost rate times T_s: contribution to u of one bar of error in one sample without response.
    Boost,
}

impl Coefficient {
    /// Returns the factor on which only this product depends.
    pub const fn factor(self) -> Field {
        match self {
            Self::Integral => Field::IntegralTime,
            Self::Derivative => Field::DerivativeTime,
            Self::Boost => Field::BoostRate,
        }
    }

    const fn unit(self) -> &'static str {
        match self {
            Self::Integral | Self::Boost => "%/bar per sample",
            Self::Derivative => "% per bar of change in a sample",
        }
    }
}

impl fmt::Display for Coefficient {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Integral => "gain * sample_time / integral_time",
            Self::Derivative => "gain * derivative_time / sample_time",
            Self::Boost => "boost_rate * sample_time",
        })
    }
}

/// Error: a [`Config`](crate::Config) has other mechanisms than a [`FixedConfig`](crate::FixedConfig).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[error(
    "{mechanism} is another one than was compiled in: choose that one, or run this configuration with `step`"
)]
pub struct OtherMechanism {
    /// First choice that differs.
    pub mechanism: Field,
}

/// Reason why words are no valid [`State`](crate::State): no sequence of samples leads to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StateError {
    /// The pressure of the previous sample is outside the control range.
    #[error(
        "word 0: pressure of {bits} units of 2^-16 bar is outside the control range of -16 ..< 16 bar"
    )]
    Pressure {
        /// Value that was read.
        bits: i32,
    },
    /// The error of the previous sample is not a difference of two pressures of the control range.
    #[error("word 1: error of {bits} units of 2^-16 bar is outside -32 ..= 32 bar")]
    Error {
        /// Value that was read.
        bits: i32,
    },
    /// The integral part is beyond the largest bound that settings allow.
    #[error(
        "words 2 and 3: integral part of {bits} units of 2^-59 is outside -10 ..= 10, which is 1000 %"
    )]
    Integral {
        /// Value that was read.
        bits: i64,
    },
    /// The boost is negative, or beyond the largest bound that settings allow.
    #[error("words 4 and 5: boost of {bits} units of 2^-52 is outside 0 ..= 10, which is 1000 %")]
    Boost {
        /// Value that was read.
        bits: i64,
    },
}
