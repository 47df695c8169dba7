//! How a sample came to its output.

use crate::control_signal::ControlSignal;
use crate::pressure::{ERROR_SHIFT, Pressure};
use crate::state::State;

/// How a sample came to its output, for logs and plots; computed only by [`step_traced`](crate::step_traced).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trace {
    /// Reference - chamber pressure, both within the control range.
    pub error: Pressure,
    /// The error that the prediction expects (equations 6.8, 6.10); the error itself where prediction is off. Beyond ±32 bar
    /// only its side is right.
    pub predicted_error: Pressure,
    /// K eₙ; 0 while the valves are turned off.
    pub proportional: ControlSignal,
    /// K T_d (eₙ - eₙ₋₁)/T_s; 0 while the valves are turned off.
    pub derivative: ControlSignal,
    /// K T_s/T_i Σ eₖ, bounded.
    pub integral: ControlSignal,
    /// The extra integrator.
    pub boost: ControlSignal,
    /// Sum of the four parts; 0 while the valves are turned off.
    pub u_unsaturated: ControlSignal,
    /// Control signal that the distributor gets.
    pub u: ControlSignal,
    /// What decided.
    pub activity: Activity,
    /// Whether ±100 % cut u.
    pub saturation: Saturation,
    /// Whether the integral part followed this sample's error: not while turned off, frozen or drawn back by anti-windup.
    pub integrating: bool,
    /// Whether the boost took this sample's error.
    pub boosting: bool,
}

/// What decided about the valves in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Activity {
    /// The PID controller.
    Controlling,
    /// The tolerance turned both off.
    InsideTolerance,
    /// The prediction turned both off.
    SwitchedOffAhead,
}

/// Which end cut the control signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Saturation {
    /// None.
    None,
    /// 100 %.
    High,
    /// -100 %.
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
    /// The account of a sample that left this state and turned the valves off.
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
