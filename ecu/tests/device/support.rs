//! Distinguishable settings, and samples.

use ecu::calibration::{CheckedSettings, SettingId, SettingValues};
use ecu::controller::Field;
use ecu::controller::fixed::types::I16F16;
use ecu::{EcuSettings, PressureSensor, SensorCode};
use hil_protocol::Sensors;

pub(crate) fn defaults() -> CheckedSettings {
    CheckedSettings::new(&EcuSettings::bench()).unwrap()
}

/// Returns the settings of the bench with another gain.
pub(crate) fn with_gain(gain: i32) -> SettingValues {
    let mut values = SettingValues::of(&EcuSettings::bench());
    values.set(
        SettingId::Controller(Field::Gain),
        I16F16::from_num(gain).to_bits(),
    );
    values
}

/// Returns the sensor's code nearest to a pressure (2⁻¹⁶ bar gauge).
pub(crate) fn code(pressure: i32) -> u16 {
    (0..4096)
        .min_by_key(|&code| {
            let code = SensorCode::from_bits(code).unwrap();
            PressureSensor::pressure(code).to_bits().abs_diff(pressure)
        })
        .unwrap()
}

/// Returns the sensors of a healthy rig: reference 0 in the first 20 samples, then 3 bar, and the pressure follows
/// slowly.
pub(crate) fn healthy(sample: u32) -> Sensors {
    let asked_for = sample.saturating_sub(20).min(1).cast_signed() * (3 << 16);
    let reached = (sample.saturating_sub(25).min(200).cast_signed() * (3 << 16)) / 200;
    Sensors {
        sample,
        elapsed_us: 10_000,
        reference: Some(asked_for),
        pressure: Some(code(reached)),
        current_fill_ma: None,
        current_vent_ma: None,
        battery_mv: Some(24_000),
    }
}
