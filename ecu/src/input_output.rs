//! Inputs and outputs of a sample.

use controller::{Duty, Pressure};
use hil_protocol::{Actuators, Sensors};

use crate::sensor::SensorCode;

/// Inputs of the ECU in a sample: measured values and reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Inputs {
    /// Time since the previous sample by the ECU's clock (µs); nominally 10 000.
    pub elapsed_us: u32,
    /// Reference for the chamber pressure; `None`: no valid message in this sample.
    pub reference: Option<Pressure>,
    /// Code of the pressure sensor; `None`: the converter did not answer, or the code had more than 12 bits.
    pub pressure: Option<SensorCode>,
    /// Current of the fill valve's coil, mean over the last PWM period (mA); `None`: not measured.
    pub current_fill_ma: Option<u16>,
    /// Current of the vent valve's coil, mean over the last PWM period (mA); `None`: not measured.
    pub current_vent_ma: Option<u16>,
    /// Supply voltage of the ECU (mV); `None`: not measured.
    pub battery_mv: Option<u16>,
}

impl From<Sensors> for Inputs {
    fn from(sensors: Sensors) -> Self {
        Self {
            elapsed_us: sensors.elapsed_us,
            reference: sensors.reference.map(Pressure::from_bits),
            pressure: sensors.pressure.and_then(SensorCode::from_bits),
            current_fill_ma: sensors.current_fill_ma,
            current_vent_ma: sensors.current_vent_ma,
            battery_mv: sensors.battery_mv,
        }
    }
}

/// Duty cycles of the two coils until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Outputs {
    /// Duty cycle of the fill valve's coil.
    pub duty_fill: Duty,
    /// Duty cycle of the vent valve's coil.
    pub duty_vent: Duty,
}

impl From<Outputs> for Actuators {
    fn from(outputs: Outputs) -> Self {
        // A duty cycle is never negative.
        Self {
            duty_fill: outputs.duty_fill.to_bits().unsigned_abs(),
            duty_vent: outputs.duty_vent.to_bits().unsigned_abs(),
        }
    }
}

/// Returns the safe state, which is defined only here: no current in either coil. The fill valve is closed; a normally
/// open vent valve empties the chamber, a normally closed one keeps the pressure (`docs/safety.md`).
pub const fn safe_outputs() -> Outputs {
    Outputs {
        duty_fill: Duty::OFF,
        duty_vent: Duty::OFF,
    }
}
