//! Structure: the mechanisms of a controller, which are the choices in [`Settings`] without the numbers.

use crate::anti_windup::AntiWindup;
use crate::lower_limit::LowerLimit;
use crate::settings::{
    Distributor, IntegralAtReference, Prediction, PredictionBasis, Settings, SwitchOff,
};
use crate::table::Field;

/// Choices of a controller. If they are constant, the compiler removes the mechanisms that are not chosen. Any
/// structure runs with any coefficients within the ranges of docs/numerics.md.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Structure {
    pub(crate) prediction: Prediction,
    pub(crate) prediction_basis: PredictionBasis,
    pub(crate) switch_off: SwitchOff,
    pub(crate) integral_at_reference: IntegralAtReference,
    pub(crate) anti_windup: AntiWindup,
    pub(crate) scheme: Scheme,
    pub(crate) lower_limit: LowerLimit,
}

impl Structure {
    pub(crate) const fn of(settings: &Settings) -> Self {
        Self {
            prediction: settings.prediction,
            prediction_basis: settings.prediction_basis,
            switch_off: settings.switch_off,
            integral_at_reference: settings.integral_at_reference,
            anti_windup: AntiWindup::of(settings),
            scheme: Scheme::of(settings),
            lower_limit: LowerLimit::of(settings),
        }
    }

    /// Returns the first choice in which the two differ.
    pub(crate) const fn difference(self, other: Self) -> Option<Field> {
        // Constant functions have no `==` on enums.
        if self.prediction as u8 != other.prediction as u8 {
            Some(Field::Prediction)
        } else if self.prediction_basis as u8 != other.prediction_basis as u8 {
            Some(Field::PredictionBasis)
        } else if self.switch_off as u8 != other.switch_off as u8 {
            Some(Field::SwitchOff)
        } else if self.integral_at_reference as u8 != other.integral_at_reference as u8 {
            Some(Field::IntegralAtReference)
        } else if self.anti_windup as u8 != other.anti_windup as u8 {
            Some(Field::AntiWindup)
        } else if self.scheme as u8 != other.scheme as u8 {
            Some(Field::Distributor)
        } else if self.lower_limit as u8 != other.lower_limit as u8 {
            Some(Field::DutyMin)
        } else {
            None
        }
    }
}

/// Valves that are driven at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum Scheme {
    /// Only the valve that u asks for; the other is off (6.3.1).
    Separate,
    /// The valve that u asks for above its middle, the other below its own middle (6.3.2).
    Together,
}

impl Scheme {
    pub(crate) const fn of(settings: &Settings) -> Self {
        match settings.distributor {
            Distributor::Traditional | Distributor::Scheme1 => Self::Separate,
            Distributor::Scheme2 { .. } => Self::Together,
        }
    }
}
