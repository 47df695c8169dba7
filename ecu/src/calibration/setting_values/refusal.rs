//! Conversion of a configuration error into a refusal that names the responsible number.

use controller::fixed::types::I16F16;
use controller::{ConfigError, Field};
use hil_protocol::Refusal;

use crate::calibration::setting::SettingId as Id;
use crate::error::EcuConfigError;
use crate::table::EcuField;

/// Returns the same error with numbers of the table, for the wire.
pub(super) fn refusal(error: &EcuConfigError) -> Refusal {
    match *error {
        EcuConfigError::OutOfRange {
            field,
            value,
            min,
            max,
        } => out_of_range(Id::Ecu(field), value, min, max, None),
        EcuConfigError::PulsesOnNormallyOpen => Refusal::OutOfRange {
            id: Id::Controller(Field::Pulses).number(),
            value: 1,
            min: 0,
            max: 0,
            bound_by: Some(Id::Ecu(EcuField::VentValve).number()),
        },
        EcuConfigError::Controller(error) => match error {
            ConfigError::OutOfRange {
                field,
                value,
                min,
                max,
            } => out_of_range(Id::Controller(field), value, min, max, None),
            ConfigError::BelowOther {
                field,
                value,
                other,
                min,
                max,
            }
            | ConfigError::AboveOther {
                field,
                value,
                other,
                min,
                max,
            } => out_of_range(
                Id::Controller(field),
                value,
                min,
                max,
                Some(Id::Controller(other)),
            ),
            ConfigError::CoefficientOutOfRange {
                coefficient,
                value,
                min,
                max,
            } => Refusal::Product {
                id: Id::Controller(coefficient.factor()).number(),
                value: value.to_bits(),
                min: min.to_bits(),
                max: max.to_bits(),
            },
        },
    }
}

fn out_of_range(id: Id, value: I16F16, min: I16F16, max: I16F16, bound_by: Option<Id>) -> Refusal {
    Refusal::OutOfRange {
        id: id.number(),
        value: value.to_bits(),
        min: min.to_bits(),
        max: max.to_bits(),
        bound_by: bound_by.map(Id::number),
    }
}
