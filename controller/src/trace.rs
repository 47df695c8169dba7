//! Trace: intermediate results of a sample.

use crate::control_signal::ControlSignal;
use crate::pressure::{ERROR_SHIFT, Pressure};
use crate::state::State;

/// Intermediate results of a sample, for logs and plots; computed only by [`step_traced`](crate::step_traced).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trace {
    /// Reference - chamber pressure, both within the control range.
    pub error: Pressure,
    /// Predicted error (equations 6.8, 6.10); the error itself without prediction. Beyond ±32 bar only its sign is
    /// correct.
    pub predicted_error: Pressure,
    /// K eₙ; 0 while the valves are switched off.
    pub proportional: ControlSignal,
    /// K T_d (eₙ - eₙ₋₁)/T_s; 0 while the valves are switched off.
    pub derivative: ControlSignal,
    /// K T_s/T_i Σ eₖ, bounded.
    pub integral: ControlSignal,
    /// Boost, the extra integrator.
    pub boost: ControlSignal,
    /// Sum of the four parts; 0 while the valves are switched off.
    pub u_unsaturated: ControlSignal,
    /// Control signal that the distributor receives.
    pub u: ControlSignal,
    /// Mechanism that decided about the valves.
    pub activity: Activity,
    /// Saturation of u at ±100 %.
    pub saturation: Saturation,
    /// Whether the integral part followed this sample's error: false while the valves are off, or while anti-windup
    /// freezes or reduces it.
    pub integrating: bool,
    /// Whether the boost followed this sample's error.
    pub boosting: bool,
}

/// Mechanism that decided about the valves in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Activity {
    /// The PID controller drives the valves.
    Controlling,
    /// The deadband switched both valves off.
    InsideTolerance,
    /// The prediction switched both valves off.
    SwitchedOffAhead,
}

/// End of the range at which the control signal saturated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Saturation {
    /// No saturation.
    None,
    /// Saturated at 100 %.
    High,
    /// Saturated at -100 %.
    Low,
}

impl Saturation {
    pub(crate) fn of(unsaturated: ControlSignal) -> Self {
        if unsaturated > ControlSignal::MAX {
            Self::High
        } else if unsaturated < ControlSignal::MIN {
            Self::Low
        } else {
            Self::None
        }
    }
}

impl Trace {
    /// Creates the trace of a sample that left this state and switched the valves off.
    #[inline(always)]
    pub(crate) const fn off(state: &State, predicted_error: Pressure, activity: Activity) -> Self {
        Self {
            error: Pressure::from_bits(state.previous.error >> ERROR_SHIFT),
            predicted_error,
            proportional: ControlSignal::ZERO,
            derivative: ControlSignal::ZERO,
            integral: state.integral(),
            boost: state.boost(),
            u_unsaturated: ControlSignal::ZERO,
            u: ControlSignal::ZERO,
            activity,
            saturation: Saturation::None,
            integrating: false,
            boosting: false,
        }
    }
}
