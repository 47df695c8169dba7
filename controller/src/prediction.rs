//! The error prediction and its switch-off, section 6.5.2 and figure 6.9.

use crate::settings::{Prediction, PredictionBasis, SwitchOff};
use crate::structure::Structure;
use crate::tolerance::Tolerance;

/// eₙ₊ₕ = eₙ + h Δeₙ with h = 0, 1 or 2, equations 6.8 and 6.10; all along the direction of the error \[bar\], 2⁻²⁵.
///
/// What leaves the word is held at its end. That moves only what is beyond ±32 bar, where no tolerance reaches, and not to within.
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

/// The change that the derivative part answers to \[bar\], 2⁻²⁵: that of the error. Blind to jumps of the reference, it does not count
/// one towards the pressure: that shortens the way and moves nothing, and would open the other valve far from the reference.
#[inline(always)]
pub(crate) fn differentiated(structure: Structure, error_change: i32, pressure_change: i32) -> i32 {
    match structure.prediction_basis {
        PredictionBasis::Error => error_change,
        PredictionBasis::Pressure => error_change.max(pressure_change.wrapping_neg()),
    }
}

/// Whether the valves are to be turned off now, because of where the error will be.
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
