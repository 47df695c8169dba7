//! Input and output of a sample.

use crate::duty::Duty;
use crate::pressure::Pressure;

/// Input of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Input {
    /// Reference for the chamber pressure.
    pub reference: Pressure,
    /// Measured chamber pressure.
    pub pressure: Pressure,
}

/// Output of a sample: the duty cycles until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// Duty cycle of the fill valve.
    pub duty_fill: Duty,
    /// Duty cycle of the vent valve.
    pub duty_vent: Duty,
}

impl Output {
    /// Both valves off.
    pub const OFF: Self = Self {
        duty_fill: Duty::OFF,
        duty_vent: Duty::OFF,
    };
}
