//! What can be wrong with settings and with a saved state.

use core::fmt;

use fixed::types::{I16F16, I32F32};

/// Why [`Settings`](crate::Settings) are no configuration: which field, its value, the bound it broke.
///
/// Nothing runs with such settings; mend the named field and build again. The first culprit in the order of the fields is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConfigError {
    /// A field outside its own range.
    #[error("{field} = {value} {unit} is out of range: must be {min} ..= {max} {unit}", unit = field.unit())]
    OutOfRange {
        /// Which field.
        field: Field,
        /// What it holds.
        value: I16F16,
        /// Smallest allowed value.
        min: I16F16,
        /// Largest allowed value.
        max: I16F16,
    },
    /// A field below another field that bounds it.
    #[error("{field} = {value} {unit} is below {other} = {min} {unit}: must be {min} ..= {max} {unit}", unit = field.unit())]
    BelowOther {
        /// Which field.
        field: Field,
        /// What it holds.
        value: I16F16,
        /// The field it must not be below.
        other: Field,
        /// What that one holds: the smallest allowed value.
        min: I16F16,
        /// Largest allowed value.
        max: I16F16,
    },
    /// A field above another field that bounds it.
    #[error("{field} = {value} {unit} is above {other} = {max} {unit}: must be {min} ..= {max} {unit}", unit = field.unit())]
    AboveOther {
        /// Which field.
        field: Field,
        /// What it holds.
        value: I16F16,
        /// The field it must not be above.
        other: Field,
        /// Smallest allowed value.
        min: I16F16,
        /// What that one holds: the largest allowed value.
        max: I16F16,
    },
    /// Fields that are fine alone and together give a coefficient that the arithmetic does not hold.
    #[error(
        "{coefficient} = {value} {unit} is out of range: must be {min} ..= {max} {unit}",
        unit = coefficient.unit()
    )]
    CoefficientOutOfRange {
        /// Which product of fields.
        coefficient: Coefficient,
        /// What it comes to.
        value: I32F32,
        /// Smallest allowed value.
        min: I32F32,
        /// Largest allowed value.
        max: I32F32,
    },
}

/// A number of [`Settings`](crate::Settings), under the name that errors show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[allow(
    missing_docs,
    reason = "each variant is the settings field of the same name"
)]
pub enum Field {
    SampleTime,
    Gain,
    IntegralTime,
    DerivativeTime,
    IntegralMax,
    TrackingTime,
    Tolerance,
    BoostRate,
    BoostMax,
    BoostResponse,
    SupplyPressure,
    DutyMinFill,
    DutyMinVent,
    DutyHalfFill,
    DutyHalfVent,
    DutyMinFillWithSupplyPressure,
    DutyMinVentWithSupplyPressure,
    DutyMaxFill,
    DutyMaxVent,
    DutyMiddleFill,
    DutyMiddleVent,
}

impl Field {
    /// The unit of the field's number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::SampleTime | Self::IntegralTime | Self::DerivativeTime | Self::TrackingTime => {
                "ms"
            }
            Self::Gain => "%/bar",
            Self::Tolerance | Self::BoostResponse | Self::SupplyPressure => "bar",
            Self::BoostRate => "%/(bar s)",
            Self::IntegralMax
            | Self::BoostMax
            | Self::DutyMinFill
            | Self::DutyMinVent
            | Self::DutyHalfFill
            | Self::DutyHalfVent
            | Self::DutyMinFillWithSupplyPressure
            | Self::DutyMinVentWithSupplyPressure
            | Self::DutyMaxFill
            | Self::DutyMaxVent
            | Self::DutyMiddleFill
            | Self::DutyMiddleVent => "%",
        }
    }

    /// The name that errors show.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SampleTime => "sample_time",
            Self::Gain => "gain",
            Self::IntegralTime => "integral_time",
            Self::DerivativeTime => "derivative_time",
            Self::IntegralMax => "integral_max",
            Self::TrackingTime => "tracking_time",
            Self::Tolerance => "tolerance",
            Self::BoostRate => "boost_rate",
            Self::BoostMax => "boost_max",
            Self::BoostResponse => "boost_response",
            Self::SupplyPressure => "supply_pressure",
            Self::DutyMinFill => "duty_min_fill",
            Self::DutyMinVent => "duty_min_vent",
            Self::DutyHalfFill => "duty_min_fill_at_half",
            Self::DutyHalfVent => "duty_min_vent_at_half",
            Self::DutyMinFillWithSupplyPressure => "duty_min_fill_with_supply_pressure",
            Self::DutyMinVentWithSupplyPressure => "duty_min_vent_with_supply_pressure",
            Self::DutyMaxFill => "duty_max_fill",
            Self::DutyMaxVent => "duty_max_vent",
            Self::DutyMiddleFill => "middle_fill",
            Self::DutyMiddleVent => "middle_vent",
        }
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A product of settings that the arithmetic has to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Coefficient {
    /// K T_s / T_i: what one bar of error adds to u in one sample.
    Integral,
    /// K T_d / T_s: what one bar of change of the error in one sample adds to u.
    Derivative,
    /// Boost rate times T_s: what one bar of error adds to u in one sample without response.
    Boost,
}

impl Coefficient {
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

/// Why a [`Config`](crate::Config) is no [`FixedConfig`](crate::FixedConfig) of some mechanisms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[error(
    "{mechanism} is another one than was compiled in: choose that one, or run this configuration with `step`"
)]
pub struct OtherMechanism {
    /// The first one that differs.
    pub mechanism: Mechanism,
}

/// A choice of [`Settings`](crate::Settings), under the name that errors show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[allow(
    missing_docs,
    reason = "each variant is the settings field of the same name"
)]
pub enum Mechanism {
    Prediction,
    PredictionBasis,
    SwitchOff,
    IntegralAtReference,
    AntiWindup,
    Distributor,
    LowerLimit,
}

impl fmt::Display for Mechanism {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Prediction => "prediction",
            Self::PredictionBasis => "prediction_basis",
            Self::SwitchOff => "switch_off",
            Self::IntegralAtReference => "integral_at_reference",
            Self::AntiWindup => "anti_windup",
            Self::Distributor => "distributor",
            Self::LowerLimit => "duty_min",
        })
    }
}

/// Why words are no [`State`](crate::State): no sequence of samples leads there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StateError {
    /// The pressure of the previous sample is outside the control range.
    #[error(
        "word 0: pressure of {bits} units of 2^-16 bar is outside the control range of -16 ..< 16 bar"
    )]
    Pressure {
        /// What was read.
        bits: i32,
    },
    /// The error of the previous sample is not a difference of two pressures of the control range.
    #[error("word 1: error of {bits} units of 2^-16 bar is outside -32 ..= 32 bar")]
    Error {
        /// What was read.
        bits: i32,
    },
    /// The integral part is beyond the largest bound that settings can give it.
    #[error(
        "words 2 and 3: integral part of {bits} units of 2^-59 is outside -10 ..= 10, which is 1000 %"
    )]
    Integral {
        /// What was read.
        bits: i64,
    },
    /// The boost is negative, or beyond the largest bound that settings can give it.
    #[error("words 4 and 5: boost of {bits} units of 2^-52 is outside 0 ..= 10, which is 1000 %")]
    Boost {
        /// What was read.
        bits: i64,
    },
}
