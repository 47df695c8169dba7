//! Input and output of a sample.

use crate::arithmetic::high_product;
use crate::control_signal::ControlSignal;
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

    /// Returns the duty cycle of the fill valve less that of the vent valve, as a control signal: u of pulses, and of a
    /// distributor without limits (equations 6.3 to 6.5).
    #[inline(always)]
    pub const fn control_signal(self) -> ControlSignal {
        let duty = self
            .duty_fill
            .to_bits()
            .wrapping_sub(self.duty_vent.to_bits());
        ControlSignal::from_units(high_product(duty, UNITS_PER_DUTY))
    }
}

/// Units of a control signal per unit of a duty cycle, 2⁻³²: 2²⁰ over 100 · 2¹⁶, rounded up, so that 100 % is exact.
const UNITS_PER_DUTY: i32 = 687_194_768;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_pulse_is_a_control_signal_of_100_percent_and_venting_is_negative() {
        let output = |fill: i32, vent: i32| Output {
            duty_fill: Duty::saturating_from_bits(fill << 16),
            duty_vent: Duty::saturating_from_bits(vent << 16),
        };
        assert_eq!(output(100, 0).control_signal(), ControlSignal::MAX);
        assert_eq!(output(0, 0).control_signal(), ControlSignal::ZERO);
        let half = output(50, 0).control_signal().percent();
        assert_eq!(half.to_bits(), 50 << 12);
        assert_eq!(
            output(0, 25).control_signal().percent().to_bits(),
            -(25 << 12)
        );
    }
}
