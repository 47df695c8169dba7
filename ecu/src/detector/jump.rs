//! Detector of a pressure change that is faster than any valve can cause.

use controller::Pressure;

use crate::config::Limits;
use crate::fault::Fault;

/// Returns a fault if the change from the last plausible pressure is impossible within a sample.
#[inline(always)]
pub(crate) fn jumped(
    limits: &Limits,
    believed: Option<Pressure>,
    pressure: Pressure,
) -> Option<Fault> {
    // Pressures of a sensor have 21 bits.
    let change = pressure.to_bits().wrapping_sub(believed?.to_bits());
    (change.wrapping_abs() > limits.jump).then_some(Fault::SensorJump)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::bench_limits;

    #[test]
    fn a_change_beyond_the_limit_is_a_jump_in_both_directions() {
        let limits = bench_limits();
        let believed = Pressure::from_bits(5 << 16);
        for (change, expected) in [
            (0, None),
            (limits.jump, None),
            (-limits.jump, None),
            (limits.jump + 1, Some(Fault::SensorJump)),
            (-limits.jump - 1, Some(Fault::SensorJump)),
        ] {
            let pressure = Pressure::from_bits(believed.to_bits() + change);
            assert_eq!(jumped(&limits, Some(believed), pressure), expected);
            assert_eq!(jumped(&limits, None, pressure), None);
        }
    }

    /// The limit is twice the faster rate, 7.28/s, times 11.02 bar absolute, in 10 ms.
    #[test]
    fn the_limit_is_twice_what_the_faster_valve_does() {
        let bar = f64::from(bench_limits().jump) / 65_536.0;
        assert!((bar - 2.0 * 0.0728 * 11.02).abs() < 1e-3, "{bar}");
    }
}
