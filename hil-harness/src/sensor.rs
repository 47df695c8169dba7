//! Pressure sensor on the plant's side: conversion of a pressure into the code that the ECU reads.
//!
//! The curve is the inverse of the ECU's ([`PressureSensor`]), in floats.

use ecu::{PressureSensor, SensorCode};

use crate::wire;

/// Returns the nearest code at a pressure (Pa abs), saturated at the rails. A NaN gives the lowest code.
pub fn code(pressure_pa: f64) -> SensorCode {
    let steps = (pressure_pa - PressureSensor::LOWEST_PA as f64) / PressureSensor::STEP_PA as f64;
    let code = (steps + PressureSensor::CODE_AT_LOWEST as f64).round();
    // The conversion saturates by definition of `as`; a value beyond 12 bits is above the upper rail.
    SensorCode::from_bits(code as u16).unwrap_or(SensorCode::MAX)
}

/// Step of the ADC behind the divider of the supply voltage (mV): 12 bits over 65.5 V.
const BATTERY_STEP_MV: f64 = 16.0;

/// Returns the supply voltage (mV) that the ECU reads at `volt`: the nearest step of its ADC.
pub fn battery_mv(volt: f64) -> u16 {
    wire::battery_mv((1e3 * volt / BATTERY_STEP_MV).round() * BATTERY_STEP_MV * 1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pressure_comes_back_within_half_a_step_over_the_whole_range() {
        for step in 0..=20_400 {
            let pressure_pa = 60_000.0 + 100.0 * f64::from(step);
            let read = PressureSensor::pressure(code(pressure_pa));
            let read_pa = f64::from(read.to_bits()) / 65536.0 * 1e5 + 101_325.0;
            assert!(
                (read_pa - pressure_pa).abs() <= 256.0,
                "{pressure_pa} Pa reads as {read_pa} Pa"
            );
        }
    }

    #[test]
    fn a_pressure_beyond_the_range_is_held_at_the_rails() {
        for (pressure_pa, expected) in [
            (0.0, SensorCode::MIN),
            (3e6, SensorCode::MAX),
            (f64::INFINITY, SensorCode::MAX),
            (f64::NAN, SensorCode::MIN),
        ] {
            assert_eq!(code(pressure_pa), expected, "{pressure_pa}");
        }
    }
}
