//! What goes in and what comes out in a sample.

use controller::{Duty, Pressure};
use hil_protocol::{Actuators, Sensors};

use crate::sensor::SensorCode;

/// What the ECU measured and was told in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Inputs {
    /// Time since the sample before by the ECU's clock \[µs\]; 10 000 nominal.
    pub elapsed_us: u32,
    /// Reference of the chamber pressure; none: no valid message in this sample.
    pub reference: Option<Pressure>,
    /// Code of the pressure sensor; none: the converter did not answer, or with more than 12 bits.
    pub pressure: Option<SensorCode>,
    /// Current of the fill valve's coil, mean over the last PWM period \[mA\]; none: not measured.
    pub current_fill_ma: Option<u16>,
    /// Current of the vent valve's coil, mean over the last PWM period \[mA\]; none: not measured.
    pub current_vent_ma: Option<u16>,
    /// Supply voltage of the ECU \[mV\]; none: not measured.
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

/// What the two coils get until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Outputs {
    /// Coil of the fill valve.
    pub duty_fill: Duty,
    /// Coil of the vent valve.
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

/// The safe state, stated once: no current in either coil. The fill valve is closed; a normally open vent valve empties the
/// chamber, a normally closed one holds the pressure (`docs/safety.md`).
pub const fn safe_outputs() -> Outputs {
    Outputs {
        duty_fill: Duty::OFF,
        duty_vent: Duty::OFF,
    }
}
