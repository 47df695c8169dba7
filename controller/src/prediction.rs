//! The error prediction and its switch-off, section 6.5.2 and figure 6.9.

use crate::arithmetic::differ_in_sign;
use crate::settings::{self, PredictionBasis, Settings, SwitchOff};
use crate::tolerance::Tolerance;

/// eₙ₊ₕ = eₙ + h Δeₙ with h = 0, 1 or 2: equations 6.8 and 6.10 in one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Prediction {
    /// h, 0 ..= 2 samples.
    horizon: i32,
    from_pressure: bool,
    also_beyond: bool,
}

impl Prediction {
    pub(crate) const fn new(settings: &Settings) -> Self {
        Self {
            horizon: match settings.prediction {
                settings::Prediction::Off => 0,
                settings::Prediction::OneStep => 1,
                settings::Prediction::TwoStep => 2,
            },
            from_pressure: matches!(settings.prediction_basis, PredictionBasis::Pressure),
            also_beyond: matches!(settings.switch_off, SwitchOff::InsideOrBeyond),
        }
    }

    /// The predicted error [2⁻¹⁶ bar].
    #[inline(always)]
    pub(crate) const fn predicted(
        &self,
        error: i32,
        error_change: i32,
        pressure_change: i32,
    ) -> i32 {
        let change = if self.from_pressure {
            pressure_change.wrapping_neg()
        } else {
            error_change
        };
        // |e| ≤ 2²¹, |change| ≤ 2²², h ≤ 2: at most 5·2²¹.
        error.wrapping_add(change.wrapping_mul(self.horizon))
    }

    /// Whether the valves are to be turned off now, because of where the error will be.
    #[inline(always)]
    pub(crate) const fn switches_off(
        &self,
        tolerance: Tolerance,
        error: i32,
        predicted: i32,
    ) -> bool {
        tolerance.holds(predicted) || (self.also_beyond && differ_in_sign(error, predicted))
    }
}
