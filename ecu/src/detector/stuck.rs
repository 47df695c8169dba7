//! Detector of a sensor that shows the same code although the valves are driven.

use controller::{Output, Pressure};

use crate::config::Limits;
use crate::fault::{Fault, FaultSet};
use crate::sensor::SensorCode;

/// Count N of a stuck sensor (samples in which a valve was driven).
const STUCK_N: u8 = Fault::SensorStuck.samples();
/// Pressure below which a vent valve hardly changes the pressure: 0.5 bar gauge, 2⁻¹⁶.
pub(crate) const ROOM_TO_FALL: i32 = 1 << 15;

/// Counter of driven samples without a single changed bit.
///
/// A valve that stays shut looks the same except for the noise of the sensor, which changes a bit now and then. At rest
/// no valve is driven and nothing is counted: a sensor that is stuck at rest is not detected before the next command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct StuckDetector {
    code: SensorCode,
    unmoved: u8,
}

impl StuckDetector {
    pub(crate) const NEW: Self = Self {
        code: SensorCode::MIN,
        unmoved: 0,
    };

    /// Takes a sample; `opening` is the last command to the valves, `pressure` that of the code.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        limits: &Limits,
        opening: Output,
        code: SensorCode,
        pressure: Pressure,
    ) {
        let is_filled = !opening.duty_fill.is_off() & (pressure.to_bits() < limits.supply_min);
        let is_vented = !opening.duty_vent.is_off() & (pressure.to_bits() > ROOM_TO_FALL);
        let is_driven = is_filled | is_vented;
        self.unmoved = if code == self.code {
            self.unmoved.saturating_add(is_driven.into())
        } else {
            0
        };
        self.code = code;
    }

    #[inline(always)]
    pub(crate) fn faults(&self, limits: &Limits) -> FaultSet {
        let n = limits.mechanisms.samples(STUCK_N);
        FaultSet::when(self.unmoved >= n, Fault::SensorStuck)
    }
}

#[cfg(test)]
mod tests {
    use controller::Duty;

    use super::*;
    use crate::detector::bench_limits;
    use crate::sensor::PressureSensor;

    const FILLED: Output = Output {
        duty_fill: Duty::FULL,
        duty_vent: Duty::OFF,
    };
    const VENTED: Output = Output {
        duty_fill: Duty::OFF,
        duty_vent: Duty::FULL,
    };

    fn code(bits: u16) -> SensorCode {
        SensorCode::from_bits(bits).unwrap()
    }

    fn sampled(detector: &mut StuckDetector, opening: Output, code: SensorCode) -> bool {
        let limits = bench_limits();
        detector.sample(&limits, opening, code, PressureSensor::pressure(code));
        detector.faults(&limits).contains(Fault::SensorStuck)
    }

    /// Returns whether the code counts as stuck after one sample with it and `samples` more.
    fn is_stuck_after(opening: Output, bits: u16, samples: usize) -> bool {
        let mut detector = StuckDetector::NEW;
        sampled(&mut detector, opening, code(bits));
        let mut is_stuck = false;
        for _ in 0..samples {
            is_stuck = sampled(&mut detector, opening, code(bits));
        }
        is_stuck
    }

    #[test]
    fn n_driven_samples_without_a_changed_bit_confirm_and_one_less_does_not() {
        let both = Output {
            duty_vent: Duty::FULL,
            ..FILLED
        };
        for opening in [FILLED, VENTED, both] {
            for (samples, expected) in [(49, false), (50, true), (51, true), (1000, true)] {
                assert_eq!(
                    is_stuck_after(opening, 1000, samples),
                    expected,
                    "{samples}"
                );
            }
        }
    }

    #[test]
    fn at_rest_nothing_is_counted_and_nothing_forgotten() {
        let mut detector = StuckDetector::NEW;
        sampled(&mut detector, FILLED, code(1000));
        for _ in 0..49 {
            assert!(!sampled(&mut detector, FILLED, code(1000)));
        }
        for _ in 0..1000 {
            assert!(!sampled(&mut detector, Output::OFF, code(1000)));
        }
        assert!(sampled(&mut detector, FILLED, code(1000)));
    }

    #[test]
    fn one_changed_bit_and_it_counts_anew() {
        let mut detector = StuckDetector::NEW;
        for sample in 0..1000 {
            let shown = code(1000 + (sample / 49) % 2);
            assert!(!sampled(&mut detector, FILLED, shown), "{sample}");
        }
    }

    /// A full chamber cannot be filled, an empty one cannot be vented.
    #[test]
    fn a_valve_counts_only_where_it_has_something_to_move() {
        let limits = bench_limits();
        let first = |is_there: &dyn Fn(i32) -> bool| {
            let shows = |&bits: &u16| is_there(PressureSensor::pressure(code(bits)).to_bits());
            (0..4096).find(shows).unwrap()
        };
        let full = first(&|bits| bits >= limits.supply_min);
        assert!(is_stuck_after(FILLED, full - 1, 50));
        assert!(!is_stuck_after(FILLED, full, 200));
        let not_empty = first(&|bits| bits > ROOM_TO_FALL);
        let not_empty_bits = PressureSensor::pressure(code(not_empty)).to_bits();
        assert!((not_empty_bits - (1 << 15)).abs() < 350, "half a bar");
        assert!(is_stuck_after(VENTED, not_empty, 50));
        assert!(!is_stuck_after(VENTED, not_empty - 1, 200));
    }

    #[test]
    fn at_its_bound_a_pressure_leaves_nothing_to_move_and_a_unit_inside_it_does() {
        let limits = bench_limits();
        for (opening, bound, inside) in [
            (FILLED, limits.supply_min, limits.supply_min - 1),
            (VENTED, ROOM_TO_FALL, ROOM_TO_FALL + 1),
        ] {
            for (bits, expected) in [(bound, false), (inside, true)] {
                let mut detector = StuckDetector::NEW;
                for _ in 0..51 {
                    detector.sample(&limits, opening, code(1000), Pressure::from_bits(bits));
                }
                let is_stuck = !detector.faults(&limits).is_empty();
                assert_eq!(is_stuck, expected, "{bits}");
            }
        }
    }
}
