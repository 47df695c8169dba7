//! Prediction of the error, and the switch-off by it (section 6.5.2 and figure 6.9).

use crate::settings::{Prediction, PredictionBasis, SwitchOff};
use crate::structure::Structure;
use crate::tolerance::Tolerance;

/// Returns eₙ₊ₕ = eₙ + h Δeₙ with h = 0, 1 or 2 (equations 6.8 and 6.10), all along the direction of the error (bar),
/// 2⁻²⁵.
///
/// The sum saturates. That changes only results beyond ±32 bar, which is outside of every deadband, and leaves them
/// outside.
#[inline(always)]
pub(crate) const fn predicted(
    structure: Structure,
    error: i32,
    error_change: i32,
    pressure_change: i32,
) -> i32 {
    let change = match structure.prediction_basis {
        PredictionBasis::Error => error_change,
        PredictionBasis::Pressure => pressure_change.wrapping_neg(),
    };
    match structure.prediction {
        Prediction::Off => error,
        Prediction::OneStep => error.saturating_add(change),
        Prediction::TwoStep => error.saturating_add(change.saturating_add(change)),
    }
}

/// Returns the change of the error that the derivative part uses (bar), 2⁻²⁵. With the pressure as basis, a jump of the
/// reference towards the pressure is not counted. Such a jump makes the error smaller without a motion of the pressure,
/// and would open the other valve far from the reference.
#[inline(always)]
pub(crate) fn differentiated(structure: Structure, error_change: i32, pressure_change: i32) -> i32 {
    match structure.prediction_basis {
        PredictionBasis::Error => error_change,
        PredictionBasis::Pressure => error_change.max(pressure_change.wrapping_neg()),
    }
}

/// Returns whether the predicted error switches the valves off now.
#[inline(always)]
pub(crate) const fn switches_off(
    structure: Structure,
    tolerance: Tolerance,
    predicted: i32,
) -> bool {
    match structure.switch_off {
        SwitchOff::InsideTolerance => tolerance.holds(predicted),
        SwitchOff::InsideOrBeyond => tolerance.is_reached(predicted),
    }
}
