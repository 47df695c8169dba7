//! Detector of coil faults by the coil current.

use controller::Duty;

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};
use crate::history::History;

/// Debounce count N of a coil current (PWM periods, one in each sample).
const COIL_N: u8 = Fault::FillCoilOpen.samples();
/// Lowest duty cycle at which a coil counts as energised: 20 %, 2⁻¹⁶. Below, the current may decay to zero within each
/// period.
pub(crate) const ENERGISED_MIN: i32 = 20 << 16;

/// Detector of one coil; a current that is not measured is not checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CoilDetector {
    energised: History,
    off: History,
    open: Debounce,
    short: Debounce,
}

impl CoilDetector {
    pub(crate) const NEW: Self = Self {
        energised: History::UNKNOWN,
        off: History::UNKNOWN,
        open: Debounce::CLEAR,
        short: Debounce::CLEAR,
    };

    /// Takes the mean current over the last PWM period (mA). With a supply voltage (mV) above its window, a healthy coil
    /// takes more than its largest current.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        limits: &Limits,
        current_ma: Option<u16>,
        battery_mv: Option<u16>,
    ) {
        let Some(current_ma) = current_ma else { return };
        let n = limits.mechanisms.samples(COIL_N);
        let takes_some = current_ma >= limits.coil_min_ma;
        let is_energised = self.energised.held_through(limits.settling);
        self.open.update(is_energised && !takes_some, n);
        let is_off = self.off.held_through(limits.settling);
        let is_overvoltage = battery_mv.is_some_and(|now| now > limits.battery_max_mv);
        let takes_too_much = current_ma > limits.coil_max_ma && !is_overvoltage;
        self.short.update(takes_too_much || is_off && takes_some, n);
    }

    /// Records the duty cycle that was just applied to the coil.
    #[inline(always)]
    pub(crate) fn command(&mut self, duty: Duty) {
        self.energised.push(duty.to_bits() >= ENERGISED_MIN);
        self.off.push(duty.is_off());
    }

    #[inline(always)]
    pub(crate) fn faults(&self, open: Fault, short: Fault) -> FaultSet {
        FaultSet::when(self.open.is_confirmed(), open)
            .union(FaultSet::when(self.short.is_confirmed(), short))
    }
}

#[cfg(test)]
mod tests {
    use controller::fixed::types::I16F16;

    use super::*;
    use crate::detector::bench_limits;

    /// Returns the faults of a coil that has this duty cycle for `command` samples, then also this current for `samples`
    /// more.
    fn faults_after(percent: &str, command: usize, current_ma: u16, samples: usize) -> FaultSet {
        let duty = Duty::from_percent(percent.parse::<I16F16>().unwrap()).unwrap();
        let mut coil = CoilDetector::NEW;
        for _ in 0..command {
            coil.command(duty);
        }
        for _ in 0..samples {
            coil.sample(&bench_limits(), Some(current_ma), Some(24_000));
            coil.command(duty);
        }
        coil.faults(Fault::VentCoilOpen, Fault::VentCoilShort)
    }

    #[test]
    fn n_periods_without_current_are_an_open_coil_and_one_less_is_none() {
        let open = FaultSet::of(Fault::VentCoilOpen);
        for (samples, expected) in [(2, FaultSet::NONE), (3, open), (4, open)] {
            for (percent, current_ma) in [("20", 0), ("20", 14), ("100", 14)] {
                assert_eq!(faults_after(percent, 6, current_ma, samples), expected);
            }
        }
        for (percent, current_ma) in [("20", 15), ("19.9999", 0), ("100", 640)] {
            assert_eq!(faults_after(percent, 6, current_ma, 9), FaultSet::NONE);
        }
    }

    #[test]
    fn n_periods_with_too_much_current_are_a_short_at_any_duty_cycle() {
        let short = FaultSet::of(Fault::VentCoilShort);
        for (samples, expected) in [(2, FaultSet::NONE), (3, short), (4, short)] {
            for percent in ["0", "10", "50", "100"] {
                let found = faults_after(percent, 0, 641, samples);
                assert_eq!(found, expected, "{percent} %, {samples}");
            }
        }
    }

    /// Defect seen: in a load dump to 58 V, the coil that held a normally open vent valve shut counted as shorted.
    #[test]
    fn the_current_of_an_overvoltage_is_no_short_unless_the_coil_is_off() {
        let limits = bench_limits();
        for (battery_mv, current_ma, duty, expected) in [
            (Some(limits.battery_max_mv + 1), 700, Duty::FULL, false),
            (Some(limits.battery_max_mv), 700, Duty::FULL, true),
            (None, 700, Duty::FULL, true),
            (Some(58_000), 700, Duty::OFF, true),
        ] {
            let mut coil = CoilDetector::NEW;
            for _ in 0..20 {
                coil.sample(&limits, Some(current_ma), battery_mv);
                coil.command(duty);
            }
            let faults = coil.faults(Fault::VentCoilOpen, Fault::VentCoilShort);
            let is_short = faults == FaultSet::of(Fault::VentCoilShort);
            assert_eq!(is_short, expected, "{battery_mv:?} mV, {duty:?}");
        }
    }

    #[test]
    fn current_without_command_is_a_short_once_it_had_time_to_decay() {
        let short = FaultSet::of(Fault::VentCoilShort);
        for (samples, expected) in [(2, FaultSet::NONE), (3, short), (4, short)] {
            assert_eq!(faults_after("0", 6, 15, samples), expected, "{samples}");
        }
        assert_eq!(faults_after("0", 6, 14, 9), FaultSet::NONE);
        // The first checked sample is the one after six samples without command.
        for (samples, expected) in [(8, FaultSet::NONE), (9, short)] {
            assert_eq!(faults_after("0", 0, 15, samples), expected, "{samples}");
        }
    }

    #[test]
    fn an_open_coil_is_judged_only_after_the_settling_time() {
        let open = FaultSet::of(Fault::VentCoilOpen);
        for (samples, expected) in [(8, FaultSet::NONE), (9, open)] {
            assert_eq!(faults_after("80", 0, 0, samples), expected, "{samples}");
        }
    }

    #[test]
    fn a_current_that_is_not_measured_is_not_judged() {
        let mut coil = CoilDetector::NEW;
        for _ in 0..100 {
            coil.sample(&bench_limits(), None, Some(24_000));
            coil.command(Duty::FULL);
        }
        let faults = coil.faults(Fault::FillCoilOpen, Fault::FillCoilShort);
        assert_eq!(faults, FaultSet::NONE);
    }
}
