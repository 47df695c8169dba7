//! Sensor wires, and pressures that cannot be.

use controller::Pressure;

use crate::config::Limits;
use crate::fault::Fault;
use crate::sensor::SensorCode;

/// Up to this code the wire is open or shorted to ground: a quarter of the way to the end of the sensor's span.
pub(crate) const RAIL_LOW: u16 = 12;
/// From this code on the wire is shorted to the supply.
pub(crate) const RAIL_HIGH: u16 = 4084;
/// The lowest code of the span less 80 mbar of noise and error. Lowest ambient pressure on a road, 5500 m high: 0.5 bar abs.
pub(crate) const CODE_MIN: u16 = 32;

/// What is wrong with a code that no sound sensor gives in a sound chamber; `pressure` is the code's.
#[inline(always)]
pub(crate) fn out_of_range(limits: &Limits, code: SensorCode, pressure: Pressure) -> Option<Fault> {
    let bits = code.bits();
    if bits < CODE_MIN {
        Some(if bits <= RAIL_LOW {
            Fault::SensorOpen
        } else {
            Fault::SensorBelowRange
        })
    } else if pressure.to_bits() > limits.pressure_max {
        Some(if bits >= RAIL_HIGH {
            Fault::SensorShort
        } else {
            Fault::SensorAboveRange
        })
    } else {
        None
    }
}
