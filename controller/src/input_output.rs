//! What goes in and what comes out in a sample.

use crate::duty::Duty;
use crate::pressure::Pressure;

/// What the controller is told in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Input {
    /// Reference of the chamber pressure.
    pub reference: Pressure,
    /// Measured chamber pressure.
    pub pressure: Pressure,
}

/// What the valves get until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// Fill valve.
    pub duty_fill: Duty,
    /// Vent valve.
    pub duty_vent: Duty,
}

impl Output {
    /// Both valves off.
    pub const OFF: Self = Self {
        duty_fill: Duty::OFF,
        duty_vent: Duty::OFF,
    };
}
