//! Comparison of the pressure with the model of the valve commands.

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};
use crate::valve::Valves;

/// Debounce count N of a sum above [`EXCESS_MAX`] (samples).
const RESPONSE_N: u8 = Fault::NoRise.samples();
/// Largest difference between the pressure and the range that the commands explain: 0.5 bar, 2⁻¹⁶. It exceeds the
/// peak-to-peak value of a noise burst of ten times the noise of the sensor.
pub(crate) const EXCESS_MAX: i32 = 1 << 15;
/// Upper bound of the sums, slightly above the limit, so that the sum decays soon after the excess has ended.
const EXCESS_END: i32 = EXCESS_MAX + (EXCESS_MAX >> 3);
/// Largest pressure change of a shut chamber in a sample: 5 mbar, 2⁻¹⁶. Causes are leaks, and gas that takes the walls'
/// temperature after it was compressed: at most 15 % of a step within about two seconds.
pub(crate) const CREEP: i32 = 328;

/// Pressure drop in a sample above which the drop is not noise: 31 mbar, 2⁻¹⁶, five times the difference of two samples
/// of the bench's noise.
pub(crate) const FALLING: i32 = 1 << 11;

/// Two cumulative sums of the pressure change that no command explains (Page, Biometrika 41, 1954).
///
/// The model gives bounds, not a pressure. A certainly open valve moves the pressure by at least half of its rate times
/// the pressure difference across it; this is valid for choked and subsonic flow. A certainly shut valve moves it by
/// the creep at most. A valve in an unknown state explains any change in its direction. Changes telescope in a sum, so
/// noise contributes no more than its own amplitude.
///
/// ```text
///   change   │  too little: vent valve shut for sure      too much: fill valve shut for sure
///  bounds    │  least = fill open for sure ? rise : 0       most = vent open for sure ? -fall : 0
///  per sample│  S ← max(0, S + least - creep - change)      S ← max(0, S + change - most - creep)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ResponseDetector {
    before: Option<i32>,
    too_little: Excess,
    too_much: Excess,
}

/// One of the sums (bar), 2⁻¹⁶, with the fault that it indicates while it exceeds the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Excess {
    sum: i32,
    debounce: Debounce,
    fault: Fault,
}

impl Excess {
    const fn new(fault: Fault) -> Self {
        Self {
            sum: 0,
            debounce: Debounce::CLEAR,
            fault,
        }
    }

    /// Adds the unexplained pressure change of this sample; `None` if a command explains any change in this direction.
    #[inline(always)]
    fn add(&mut self, unexplained: Option<i32>, fault: Fault, n: u8) {
        self.sum = match unexplained {
            // The sum and the added change are below 2²³.
            Some(unexplained) => self.sum.wrapping_add(unexplained).clamp(0, EXCESS_END),
            None => 0,
        };
        if !self.debounce.is_confirmed() {
            self.fault = fault;
        }
        self.debounce.update(self.sum > EXCESS_MAX, n);
    }

    #[inline(always)]
    fn faults(&self) -> FaultSet {
        FaultSet::when(self.debounce.is_confirmed(), self.fault)
    }
}

impl ResponseDetector {
    pub(crate) const NEW: Self = Self {
        before: None,
        too_little: Excess::new(Fault::NoRise),
        too_much: Excess::new(Fault::NoFall),
    };

    /// Takes `pressure` (bar), 2⁻¹⁶; `None` in a sample with an implausible code: the sums begin again with the next
    /// sample.
    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, valves: &Valves, pressure: Option<i32>) {
        let n = limits.mechanisms.samples(RESPONSE_N);
        let before = self.before;
        self.before = pressure;
        let (Some(before), Some(pressure)) = (before, pressure) else {
            self.too_little.add(None, Fault::NoRise, n);
            self.too_much.add(None, Fault::NoFall, n);
            return;
        };
        let Valves { fill, vent } = *valves;
        let settling = limits.settling;
        let change = pressure.wrapping_sub(before);

        let fill_is_shut = fill.is_shut(settling);
        let least = if fill.is_open(settling) {
            moved(limits.least_rise, limits.supply_min.wrapping_sub(pressure))
        } else {
            0
        };
        let too_little = if fill_is_shut {
            Fault::UncommandedFall
        } else if change < -FALLING {
            Fault::SupplyLost
        } else {
            Fault::NoRise
        };
        let missing = least.wrapping_sub(CREEP).wrapping_sub(change);
        let missing = vent.is_shut(settling).then_some(missing);
        self.too_little.add(missing, too_little, n);

        let vent_is_open = vent.is_open(settling);
        let fall = if vent_is_open {
            moved(limits.least_fall, pressure)
        } else {
            0
        };
        let too_much = if vent_is_open {
            Fault::NoFall
        } else {
            Fault::UncommandedRise
        };
        let surplus = change.wrapping_add(fall).wrapping_sub(CREEP);
        let surplus = fill_is_shut.then_some(surplus);
        self.too_much.add(surplus, too_much, n);
    }

    #[inline(always)]
    pub(crate) fn faults(&self) -> FaultSet {
        self.too_little.faults().union(self.too_much.faults())
    }
}

/// Returns the minimum pressure change by an open valve in a sample: `share` (2⁻³²) of the pressure difference across
/// it.
#[inline(always)]
fn moved(share: i32, difference: i32) -> i32 {
    ((i64::from(share).wrapping_mul(i64::from(difference.max(0)))) >> 32) as i32
}

#[cfg(test)]
mod tests {
    use controller::fixed::types::I16F16;
    use controller::{Duty, Output};

    use super::*;
    use crate::detector::bench_limits;
    use crate::duty_scales::DutyScales;
    use crate::settings::VentValve;

    /// Detector with two valves that have had the same command for a long time, and the pressure (2⁻¹⁶ bar).
    struct Command {
        detector: ResponseDetector,
        valves: Valves,
        pressure: i32,
    }

    impl Command {
        /// Creates it with these fill and vent duty cycles (%).
        fn for_long(fill: i32, vent: i32, pressure: i32) -> Self {
            let duty = |percent| Duty::from_percent(I16F16::from_num(percent)).unwrap();
            let opening = Output {
                duty_fill: duty(fill),
                duty_vent: duty(vent),
            };
            let mut valves = Valves::UNKNOWN;
            for _ in 0..40 {
                valves.record(
                    bench_limits().open_duties(VentValve::NormallyClosed, DutyScales::ONE),
                    opening,
                );
            }
            let mut command = Self {
                detector: ResponseDetector::NEW,
                valves,
                pressure,
            };
            assert_eq!(command.changes(0), FaultSet::NONE);
            command
        }

        fn sees(&mut self, pressure: Option<i32>) -> FaultSet {
            self.detector
                .sample(&bench_limits(), &self.valves, pressure);
            self.detector.faults()
        }

        fn changes(&mut self, change: i32) -> FaultSet {
            self.pressure += change;
            self.sees(Some(self.pressure))
        }

        /// Returns the sample, from 1 on, in which a fault is confirmed, with this change in each sample.
        fn confirms(&mut self, change: i32, samples: u32) -> Option<(u32, FaultSet)> {
            (1..=samples).find_map(|sample| {
                let faults = self.changes(change);
                (!faults.is_empty()).then_some((sample, faults))
            })
        }
    }

    const BAR: i32 = 1 << 16;

    /// One step; after it the sum decreases by the creep in each sample.
    #[test]
    fn n_samples_beyond_the_excess_confirm_and_one_less_does_not() {
        for (sign, fault) in [(-1, Fault::UncommandedFall), (1, Fault::UncommandedRise)] {
            for (beyond, expected) in [(2, None), (3, Some(fault)), (4, Some(fault))] {
                let mut command = Command::for_long(0, 0, 4 * BAR);
                let mut found = command.changes(sign * (EXCESS_MAX + 1 + CREEP * beyond));
                for _ in 0..5 {
                    found = found.union(command.changes(0));
                }
                let expected = expected.map_or(FaultSet::NONE, FaultSet::of);
                assert_eq!(found, expected, "{fault:?}, {beyond}");
            }
        }
    }

    #[test]
    fn a_shut_chamber_may_creep_for_ever_and_no_faster() {
        for sign in [-1, 1] {
            let mut command = Command::for_long(0, 0, 4 * BAR);
            assert_eq!(command.confirms(sign * CREEP, 10_000), None);
            let mut command = Command::for_long(0, 0, 4 * BAR);
            let (sample, _) = command.confirms(sign * (CREEP + 1), 40_000).unwrap();
            assert_eq!(sample, EXCESS_MAX.unsigned_abs() + 3);
        }
    }

    /// The minimum rise is half of 7.13/s times 7.5 bar in 10 ms: 0.267 bar.
    #[test]
    fn a_filled_chamber_that_does_not_rise_is_found_in_the_fourth_sample() {
        let mut command = Command::for_long(75, 0, 0);
        let expected = FaultSet::of(Fault::NoRise);
        assert_eq!(command.confirms(0, 10), Some((4, expected)));
        let mut command = Command::for_long(75, 0, 0);
        assert_eq!(command.confirms(-FALLING, 10), Some((4, expected)));
    }

    #[test]
    fn a_pressure_that_falls_while_filled_is_a_lost_supply() {
        let mut command = Command::for_long(75, 0, 4 * BAR);
        let (_, faults) = command.confirms(-FALLING - 1, 20).unwrap();
        assert_eq!(faults, FaultSet::of(Fault::SupplyLost));
    }

    /// The minimum fall is half of 7.28/s times 5 bar in 10 ms: 0.182 bar.
    #[test]
    fn a_vented_chamber_that_does_not_fall_is_found_in_the_fifth_sample() {
        let mut command = Command::for_long(0, 75, 5 * BAR);
        let expected = FaultSet::of(Fault::NoFall);
        assert_eq!(command.confirms(0, 10), Some((5, expected)));
    }

    #[test]
    fn what_the_open_valve_does_at_least_is_enough() {
        let limits = bench_limits();
        let mut command = Command::for_long(75, 0, 0);
        while command.pressure < limits.supply_min {
            let least = moved(limits.least_rise, limits.supply_min - command.pressure);
            assert_eq!(
                command.changes(least + 1),
                FaultSet::NONE,
                "{}",
                command.pressure
            );
        }
        let mut command = Command::for_long(0, 75, 7 * BAR);
        while command.pressure > BAR / 100 {
            let least = moved(limits.least_fall, command.pressure);
            assert_eq!(
                command.changes(-least - 1),
                FaultSet::NONE,
                "{}",
                command.pressure
            );
        }
    }

    #[test]
    fn a_full_chamber_need_not_rise_and_an_empty_one_need_not_fall() {
        let full = bench_limits().supply_min;
        assert_eq!(Command::for_long(75, 0, full).confirms(0, 1000), None);
        assert_eq!(Command::for_long(75, 0, full + BAR).confirms(0, 1000), None);
        assert_eq!(Command::for_long(0, 75, 0).confirms(0, 1000), None);
        assert_eq!(Command::for_long(0, 75, -BAR / 4).confirms(0, 1000), None);
    }

    #[test]
    fn a_valve_that_may_be_open_explains_everything_in_its_direction() {
        assert_eq!(Command::for_long(50, 0, 0).confirms(BAR / 2, 14), None);
        assert_eq!(
            Command::for_long(0, 50, 7 * BAR).confirms(-BAR / 2, 14),
            None
        );
        for change in [-BAR / 2, 0, BAR / 2] {
            assert_eq!(
                Command::for_long(75, 75, 7 * BAR).confirms(change, 14),
                None
            );
        }
    }

    #[test]
    fn a_valve_that_may_be_open_explains_nothing_in_the_other_direction() {
        let (_, faults) = Command::for_long(50, 0, 7 * BAR)
            .confirms(-BAR / 2, 14)
            .unwrap();
        assert_eq!(faults, FaultSet::of(Fault::SupplyLost));
        let (_, faults) = Command::for_long(0, 50, 0).confirms(BAR / 2, 14).unwrap();
        assert_eq!(faults, FaultSet::of(Fault::UncommandedRise));
    }

    #[test]
    fn a_sample_without_pressure_begins_anew() {
        let mut command = Command::for_long(75, 0, 0);
        for _ in 0..100 {
            assert_eq!(command.confirms(0, 3), None);
            assert_eq!(command.sees(None), FaultSet::NONE);
            assert_eq!(command.changes(BAR), FaultSet::NONE);
            command.pressure = 0;
            assert_eq!(command.sees(None), FaultSet::NONE);
            assert_eq!(command.changes(0), FaultSet::NONE);
        }
    }

    #[test]
    fn a_fault_keeps_the_name_under_which_it_was_confirmed() {
        let mut command = Command::for_long(75, 0, 4 * BAR);
        let (_, first) = command.confirms(0, 20).unwrap();
        assert_eq!(first, FaultSet::of(Fault::NoRise));
        assert_eq!(command.changes(-BAR), first);
    }

    /// The sums end an eighth above the excess: 4096 units, which decrease by 328 in each sample.
    #[test]
    fn what_is_over_is_soon_forgotten() {
        for sign in [-1, 1] {
            let mut command = Command::for_long(0, 0, 5 * BAR);
            command.changes(sign * 4 * BAR);
            let last = (1..100).filter(|_| !command.changes(0).is_empty()).max();
            assert_eq!(last, Some(12 + 2));
        }
    }

    #[test]
    fn an_open_valve_moves_a_share_of_the_difference_and_never_backwards() {
        assert_eq!(moved(1 << 30, 4 * BAR), BAR);
        assert_eq!(moved(i32::MAX, 0), 0);
        assert_eq!(moved(1 << 30, -1), 0);
        assert_eq!(moved(1 << 30, i32::MIN), 0);
    }
}
