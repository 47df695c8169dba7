//! Conversion of a configuration error into a refusal that names the responsible number.

use controller::fixed::types::I16F16;
use controller::{Coefficient, ConfigError, Field};
use hil_protocol::Refusal;

use crate::calibration::setting::SettingId as Id;
use crate::error::{EcuConfigError, SupervisionField};

/// Returns the same error with numbers of the table, for the wire.
pub(super) fn refusal(error: &EcuConfigError) -> Refusal {
    match *error {
        EcuConfigError::OutOfRange {
            field,
            value,
            min,
            max,
        } => out_of_range(supervision(field), value, min, max, None),
        EcuConfigError::Controller(error) => match error {
            ConfigError::OutOfRange {
                field,
                value,
                min,
                max,
            } => out_of_range(controller(field), value, min, max, None),
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
            } => out_of_range(controller(field), value, min, max, Some(controller(other))),
            ConfigError::CoefficientOutOfRange {
                coefficient,
                value,
                min,
                max,
            } => Refusal::Product {
                id: product(coefficient) as u16,
                value: value.to_bits(),
                min: min.to_bits(),
                max: max.to_bits(),
            },
        },
    }
}

fn out_of_range(id: Id, value: I16F16, min: I16F16, max: I16F16, bound_by: Option<Id>) -> Refusal {
    Refusal::OutOfRange {
        id: id as u16,
        value: value.to_bits(),
        min: min.to_bits(),
        max: max.to_bits(),
        bound_by: bound_by.map(|id| id as u16),
    }
}

/// Returns the factor on which only this product depends.
const fn product(coefficient: Coefficient) -> Id {
    match coefficient {
        Coefficient::Integral => Id::IntegralTime,
        Coefficient::Derivative => Id::DerivativeTime,
        Coefficient::Boost => Id::BoostRate,
    }
}

const fn controller(field: Field) -> Id {
    match field {
        Field::SampleTime => Id::SampleTime,
        Field::Gain => Id::Gain,
        Field::IntegralTime => Id::IntegralTime,
        Field::DerivativeTime => Id::DerivativeTime,
        Field::IntegralMax => Id::IntegralMax,
        Field::TrackingTime => Id::TrackingTime,
        Field::Tolerance => Id::Tolerance,
        Field::BoostRate => Id::BoostRate,
        Field::BoostMax => Id::BoostMax,
        Field::BoostResponse => Id::BoostResponse,
        Field::SupplyPressure => Id::SupplyPressure,
        Field::DutyMinFill => Id::DutyMinFill,
        Field::DutyMinVent => Id::DutyMinVent,
        Field::DutyHalfFill => Id::DutyHalfFill,
        Field::DutyHalfVent => Id::DutyHalfVent,
        Field::DutyMinFillWithSupplyPressure => Id::DutyMinFillWithSupplyPressure,
        Field::DutyMinVentWithSupplyPressure => Id::DutyMinVentWithSupplyPressure,
        Field::DutyMaxFill => Id::DutyMaxFill,
        Field::DutyMaxVent => Id::DutyMaxVent,
        Field::DutyMiddleFill => Id::DutyMiddleFill,
        Field::DutyMiddleVent => Id::DutyMiddleVent,
    }
}

const fn supervision(field: SupervisionField) -> Id {
    match field {
        SupervisionField::SupplyPressureMin => Id::SupplyPressureMin,
        SupervisionField::SupplyPressureMax => Id::SupplyPressureMax,
        SupervisionField::FillRate => Id::FillRate,
        SupervisionField::VentRate => Id::VentRate,
        SupervisionField::OpenDutyFill => Id::OpenDutyFill,
        SupervisionField::OpenDutyVent => Id::OpenDutyVent,
        SupervisionField::ValveSettling => Id::ValveSettling,
        SupervisionField::Ramp => Id::Ramp,
        SupervisionField::BatteryMin => Id::BatteryMin,
        SupervisionField::BatteryMax => Id::BatteryMax,
        SupervisionField::CoilCurrentMin => Id::CoilCurrentMin,
        SupervisionField::CoilCurrentMax => Id::CoilCurrentMax,
    }
}
