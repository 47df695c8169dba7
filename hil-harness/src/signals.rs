//! Signals of a device by name: those of the ECU and those of the image.

use ecu::calibration::{MISSING, SIGNALS, Signal};

/// Number of the image's first signal; those of the ECU are below.
const FIRST_OF_IMAGE: u16 = 0x100;

/// Signals of the image, in the order of their numbers: the timing of its samples by the timer.
const OF_IMAGE: [Signal; 7] = [
    of_image("start_latency", "us"),
    of_image("start_latency_max", "us"),
    of_image("drive_latency", "us"),
    of_image("drive_latency_max", "us"),
    of_image("interval_error", "us"),
    of_image("interval_error_max", "us"),
    of_image("ticks_missed", ""),
];

const fn of_image(name: &'static str, unit: &'static str) -> Signal {
    Signal {
        name,
        unit,
        fraction_bits: 0,
        signed: true,
    }
}

/// Returns every signal with its number in messages.
pub fn all() -> impl Iterator<Item = (u16, &'static Signal)> {
    (0..).zip(&SIGNALS).chain((FIRST_OF_IMAGE..).zip(&OF_IMAGE))
}

/// Returns the signal of this name and its number in messages.
pub fn named(name: &str) -> Option<(u16, &'static Signal)> {
    all().find(|(_, signal)| signal.name == name)
}

/// Converts a number on the wire into the signal's unit; `None` if the signal was missing in that sample.
pub fn value(signal: &Signal, number: i32) -> Option<f64> {
    let number = match (signal.signed, number) {
        (true, MISSING) => return None,
        (true, number) => f64::from(number),
        (false, number) => f64::from(number.cast_unsigned()),
    };
    Some(number / f64::from(signal.fraction_bits).exp2())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_found_with_its_own_number_and_numbers_mean_what_their_unit_says() {
        for (id, signal) in all() {
            assert_eq!(named(signal.name).unwrap().0, id);
        }
        let (_, reference) = named("p_ref").unwrap();
        assert_eq!(value(reference, 3 << 16), Some(3.0));
        assert_eq!(value(reference, MISSING), None);
        let (_, digest) = named("ecu_digest").unwrap();
        assert_eq!(value(digest, -1), Some(f64::from(u32::MAX)));
        assert!(named("no such").is_none());
    }
}
