//! Detector of sensor wire faults and of impossible pressures.

use controller::Pressure;

use crate::config::Limits;
use crate::fault::Fault;
use crate::sensor::SensorCode;

/// Highest code of an open wire or a short to ground: a quarter of the way to the end of the sensor's span.
pub(crate) const RAIL_LOW: u16 = 12;
/// Lowest code of a short to the supply.
pub(crate) const RAIL_HIGH: u16 = 4084;
/// Lowest plausible code: the lowest code of the span less 80 mbar of noise and error. Lowest ambient pressure on a
/// road, 5500 m high: 0.5 bar abs.
pub(crate) const CODE_MIN: u16 = 32;

/// Returns the fault of a code that a healthy sensor cannot give in a healthy chamber; `pressure` is the code's
/// pressure.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::bench_limits;
    use crate::sensor::PressureSensor;

    fn fault(bits: u16) -> Option<Fault> {
        let code = SensorCode::from_bits(bits).unwrap();
        out_of_range(&bench_limits(), code, PressureSensor::pressure(code))
    }

    #[test]
    fn each_code_is_a_rail_out_of_range_or_sound() {
        for (bits, expected) in [
            (0, Some(Fault::SensorOpen)),
            (12, Some(Fault::SensorOpen)),
            (13, Some(Fault::SensorBelowRange)),
            (31, Some(Fault::SensorBelowRange)),
            (32, None),
            (48, None),
            (4083, Some(Fault::SensorAboveRange)),
            (4084, Some(Fault::SensorShort)),
            (4095, Some(Fault::SensorShort)),
        ] {
            assert_eq!(fault(bits), expected, "{bits}");
        }
    }

    /// The supply gives at most 10 bar, and the sensor is within 0.2 bar.
    #[test]
    fn no_pressure_is_above_the_highest_of_the_supply_and_the_sensors_error() {
        let highest = (32..4096).filter(|&bits| fault(bits).is_none()).max();
        let code = SensorCode::from_bits(highest.unwrap()).unwrap();
        let above = SensorCode::from_bits(code.bits() + 1).unwrap();
        let bar = |code| f64::from(PressureSensor::pressure(code).to_bits()) / 65_536.0;
        assert!(bar(code) <= 10.2 && bar(above) > 10.2, "{}", bar(code));
        assert_eq!(fault(above.bits()), Some(Fault::SensorAboveRange));
    }

    #[test]
    fn the_highest_pressure_itself_is_one_that_can_be() {
        let code = SensorCode::from_bits(1000).unwrap();
        let pressure = PressureSensor::pressure(code);
        let limits = Limits {
            pressure_max: pressure.to_bits(),
            ..bench_limits()
        };
        assert_eq!(out_of_range(&limits, code, pressure), None);
    }
}
