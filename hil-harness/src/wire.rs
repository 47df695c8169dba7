//! Data on the wire, and the conversion of its numbers into the units of the plant.

use ecu::{PressureSensor, SensorCode};

pub use hil_protocol::{Actuators, Answer, Sensors, Telemetry};

/// One sample on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Exchange {
    /// Data to the device.
    pub sensors: Sensors,
    /// Data from the device.
    pub answer: Answer,
}

/// Duty cycle of 100 %, in units of the wire (2⁻¹⁶ %).
pub const FULL_DUTY: u32 = 100 << 16;

/// Returns the reference nearest to `bar` (2⁻¹⁶ bar gauge), saturated at the ends of the range; 0 for NaN.
pub fn reference_bits(bar: f64) -> i32 {
    // The conversion saturates by definition of `as`.
    (bar * 65536.0).round() as i32
}

/// Returns a pressure (bar gauge), exactly.
pub fn bar(bits: i32) -> f64 {
    f64::from(bits) / 65536.0
}

/// Returns the pressure that the ECU computes from a code of its sensor (bar gauge), exactly; NaN for an impossible
/// code.
pub fn measured_bar(code: u16) -> f64 {
    SensorCode::from_bits(code).map_or(f64::NAN, |code| {
        bar(PressureSensor::pressure(code).to_bits())
    })
}

/// Returns a duty cycle (%), exactly.
pub fn duty_pct(bits: u32) -> f64 {
    f64::from(bits) / 65536.0
}

/// Returns a control signal (%), exactly.
pub fn control_signal_pct(bits: i32) -> f64 {
    f64::from(bits) / 4096.0
}

/// Converts `ampere` into the current that the ECU reads (mA): nearest, saturated at the ends of 16 bits.
pub fn current_ma(ampere: f64) -> u16 {
    // The conversion saturates by definition of `as`.
    (1e3 * ampere).round() as u16
}

/// Converts `volt` into the voltage that the ECU reads (mV): nearest, saturated at the ends of 16 bits.
pub fn battery_mv(volt: f64) -> u16 {
    // The conversion saturates by definition of `as`.
    (1e3 * volt).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_is_off_by_at_most_half_a_unit() {
        for expected_bar in [0.0, 0.1, -0.3, 5.964, 8.4] {
            let error = (bar(reference_bits(expected_bar)) - expected_bar).abs();
            assert!(error <= 0.5 / 65536.0, "{expected_bar}: {error}");
        }
    }

    #[test]
    fn what_16_bits_do_not_hold_is_held_at_their_ends() {
        assert_eq!((current_ma(0.2924), current_ma(-1.0)), (292, 0));
        assert_eq!((battery_mv(24.0), battery_mv(100.0)), (24_000, u16::MAX));
    }
}
