//! Meaning of the numbers of a choice, in the order of the table. Choices with quantities are matched where they are
//! read and written.

use controller::{IntegralAtReference, Prediction, PredictionBasis, SwitchOff};

use crate::settings::VentValve;

pub(super) const OFF_ON: [bool; 2] = [false, true];
pub(super) const AT_REFERENCE: [IntegralAtReference; 2] =
    [IntegralAtReference::Hold, IntegralAtReference::Clear];
pub(super) const PREDICTION: [Prediction; 3] =
    [Prediction::Off, Prediction::OneStep, Prediction::TwoStep];
pub(super) const BASIS: [PredictionBasis; 2] = [PredictionBasis::Error, PredictionBasis::Pressure];
pub(super) const SWITCH_OFF: [SwitchOff; 2] =
    [SwitchOff::InsideTolerance, SwitchOff::InsideOrBeyond];
pub(super) const VENT_VALVE: [VentValve; 2] = [VentValve::NormallyClosed, VentValve::NormallyOpen];
