//! Resistance of the coils, from their mean currents.

use controller::{
    CoilMeasurement, CoilSlowness, Duty, ResistanceRatio, Slowness, SupplyCompensation,
};

use crate::config::Limits;
use crate::duty_scales::DutyScales;
use crate::fault::{Fault, FaultSet};
use crate::input_output::{Inputs, Outputs};

/// Number of times in a row that a command must equal the one before: the mean current of a PWM period belongs to a command
/// of two to four samples ago (command delay of up to two samples and a PWM period).
const REPEATED: u8 = 2;
/// Largest difference of duty cycles that count as equal: 2 %, 2⁻¹⁶.
const CONSTANT_MAX: u32 = 2 << 16;
/// Share of a current or voltage by which it may differ from that of the last sample and still counts as constant: a
/// thirty-second.
const CONSTANT_SHIFT: u32 = 5;

/// Number of samples after which a current belongs to a changed supply voltage: the age of the oldest command.
const SETTLED: u8 = 4;
/// Number of first measurements, which are hardly filtered: they leave a fortieth of a wrong start value.
const FIRST: u8 = 4;
/// Faults whose current says nothing about a resistance, before their confirmation either.
const COIL_FAULTS: FaultSet = FaultSet::of(Fault::FillCoilOpen)
    .union(FaultSet::of(Fault::FillCoilShort))
    .union(FaultSet::of(Fault::VentCoilOpen))
    .union(FaultSet::of(Fault::VentCoilShort));

/// Estimate of one coil's resistance, which is frozen while the coil is not driven at a constant duty cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Coil {
    ratio: ResistanceRatio,
    /// Number of measurements, at most [`FIRST`].
    measurements: u8,
    /// Last command and the one before.
    last: Duty,
    before: Duty,
    /// Number of times in a row that a command equalled the one before, at most [`REPEATED`].
    repeated: u8,
    /// Duty cycle to which the current of the next sample belongs; off if it was not constant.
    measured: Duty,
    current_ma: u16,
}

impl Coil {
    const NEW: Self = Self {
        ratio: ResistanceRatio::NOMINAL,
        measurements: 0,
        last: Duty::OFF,
        before: Duty::OFF,
        repeated: 0,
        measured: Duty::OFF,
        current_ma: 0,
    };

    #[inline(always)]
    fn sample(
        &mut self,
        compensation: &SupplyCompensation,
        current_ma: u16,
        supply_mv: Option<u16>,
    ) {
        let is_steady = is_steady(current_ma, self.current_ma);
        self.current_ma = current_ma;
        if is_steady && let Some(coil) = CoilMeasurement::new(self.measured, supply_mv, current_ma)
        {
            let is_first = self.measurements < FIRST;
            self.ratio = compensation.measured(self.ratio, &coil, is_first);
            self.measurements = self.measurements.saturating_add(1).min(FIRST);
        }
    }

    #[inline(always)]
    fn command(&mut self, duty: Duty) {
        self.measured = if self.repeated >= REPEATED {
            self.before
        } else {
            Duty::OFF
        };
        self.repeated = if duty.to_bits().abs_diff(self.last.to_bits()) <= CONSTANT_MAX {
            self.repeated.saturating_add(1).min(REPEATED)
        } else {
            0
        };
        self.before = self.last;
        self.last = duty;
    }

    /// Returns the ratio of this coil, or that of the other one if only that one was measured: both are in one housing.
    #[inline(always)]
    const fn ratio(&self, other: &Self) -> ResistanceRatio {
        if self.measurements == 0 && other.measurements > 0 {
            other.ratio
        } else {
            self.ratio
        }
    }
}

/// Estimate of the resistances of both coils.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CoilResistances {
    fill: Coil,
    vent: Coil,
    supply_mv: u16,
    /// Number of samples since the supply voltage changed, at most [`SETTLED`].
    steady_for: u8,
}

impl CoilResistances {
    pub(crate) const NEW: Self = Self {
        fill: Coil::NEW,
        vent: Coil::NEW,
        supply_mv: 0,
        steady_for: 0,
    };

    /// Takes the measured currents and returns the factors of the duty limits in this sample. A current or voltage outside
    /// its window may be a fault, and measures no resistance. A confirmed fault of a coil makes the resistances unknown.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        compensation: &SupplyCompensation,
        limits: &Limits,
        inputs: &Inputs,
        faults: FaultSet,
    ) -> DutyScales {
        if faults.has_any_of(COIL_FAULTS) {
            *self = Self::NEW;
        }
        let supply_mv = inputs.battery_mv;
        self.steady_for = match supply_mv {
            Some(now) if limits.has_battery(now) && is_steady(now, self.supply_mv) => {
                self.steady_for.saturating_add(1).min(SETTLED)
            }
            _ => 0,
        };
        let is_steady = self.steady_for >= SETTLED;
        self.supply_mv = supply_mv.unwrap_or(0);
        if is_steady && let Some(current_ma) = limits.coil_current(inputs.current_fill_ma) {
            self.fill.sample(compensation, current_ma, supply_mv);
        }
        if is_steady && let Some(current_ma) = limits.coil_current(inputs.current_vent_ma) {
            self.vent.sample(compensation, current_ma, supply_mv);
        }
        let vent = compensation.scale(supply_mv, self.vent.ratio(&self.fill));
        DutyScales {
            fill: compensation.scale(supply_mv, self.fill.ratio(&self.vent)),
            vent,
            release: compensation.release_shift(vent),
        }
    }

    /// Returns the slowness of both coils with these factors of the duty limits.
    #[inline(always)]
    pub(crate) fn slowness(&self, scales: DutyScales) -> CoilSlowness {
        CoilSlowness {
            fill: Slowness::of(scales.fill, self.fill.ratio(&self.vent)),
            vent: Slowness::of(scales.vent, self.vent.ratio(&self.fill)),
        }
    }

    /// Records the duty cycles that were just applied to the coils.
    #[inline(always)]
    pub(crate) fn command(&mut self, outputs: Outputs) {
        self.fill.command(outputs.duty_fill);
        self.vent.command(outputs.duty_vent);
    }
}

#[inline(always)]
const fn is_steady(now: u16, before: u16) -> bool {
    now.abs_diff(before) <= now >> CONSTANT_SHIFT
}

#[cfg(test)]
mod tests {
    use controller::fixed::types::I16F16;
    use controller::{Config, DutyScale, Settings};

    use super::*;

    /// Two coils of 114.3 ohm (120 °C), measured as on a rig: the current is that of the command of three samples ago.
    struct Rig {
        resistances: CoilResistances,
        currents_ma: [u16; 2],
        supply_mv: u16,
        faults: FaultSet,
    }

    impl Rig {
        fn new() -> Self {
            Self {
                resistances: CoilResistances::NEW,
                currents_ma: [0; 2],
                supply_mv: 24_000,
                faults: FaultSet::NONE,
            }
        }

        /// Runs samples with a fill and a vent duty cycle (%), and returns the factors after them.
        fn driven(&mut self, percent: [f64; 2], samples: u32) -> DutyScales {
            let config = Config::new(&Settings::recommended()).unwrap();
            let compensation = config.compensation().unwrap();
            let mut scales = DutyScales::ONE;
            for _ in 0..samples {
                let [fill_ma, vent_ma] = self.currents_ma;
                scales = self.resistances.sample(
                    compensation,
                    &crate::detector::bench_limits(),
                    &Inputs {
                        elapsed_us: 10_000,
                        reference: None,
                        pressure: None,
                        current_fill_ma: Some(fill_ma),
                        current_vent_ma: Some(vent_ma),
                        battery_mv: Some(self.supply_mv),
                    },
                    self.faults,
                );
                let volt = f64::from(self.supply_mv) * 1e-3;
                self.currents_ma = percent.map(|percent| {
                    let mean_v = 0.01 * (percent * volt - (100.0 - percent) * 0.8);
                    (1e3 * mean_v / 114.3).max(0.0) as u16
                });
                let duty = |percent| Duty::from_percent(I16F16::from_num(percent)).unwrap();
                let [duty_fill, duty_vent] = percent.map(duty);
                self.resistances.command(Outputs {
                    duty_fill,
                    duty_vent,
                });
            }
            scales
        }
    }

    fn factor(scale: DutyScale) -> f64 {
        f64::from(scale.to_bits()) / 65_536.0
    }

    const HOT: f64 = 114.3 / 82.2;

    #[test]
    fn twelve_samples_of_a_driven_coil_show_its_resistance_to_three_percent() {
        let mut rig = Rig::new();
        let scales = rig.driven([80.0, 0.0], 12);
        assert!((factor(scales.fill) / HOT - 1.0).abs() < 0.03, "{scales:?}");
    }

    #[test]
    fn a_coil_that_was_never_driven_takes_the_ratio_of_the_other_one() {
        let mut rig = Rig::new();
        let scales = rig.driven([0.0, 80.0], 20);
        assert_eq!(scales.fill, scales.vent);
        assert!((factor(scales.fill) / HOT - 1.0).abs() < 0.03, "{scales:?}");
    }

    #[test]
    fn a_coil_that_is_not_driven_keeps_its_ratio() {
        let mut rig = Rig::new();
        rig.driven([80.0, 0.0], 20);
        rig.driven([0.0, 0.0], 10);
        let scales = rig.driven([0.0, 0.0], 1);
        assert_eq!(rig.driven([30.0, 0.0], 1000), scales);
    }

    #[test]
    fn a_duty_cycle_that_changes_in_each_sample_shows_no_resistance() {
        let mut rig = Rig::new();
        for _ in 0..100 {
            rig.driven([50.0, 0.0], 1);
            rig.driven([80.0, 0.0], 1);
        }
        assert_eq!(rig.driven([0.0; 2], 1), Rig::new().driven([0.0; 2], 1));
    }

    /// The current is older than the voltage. Defect seen: at full duty, a voltage that rose from 17 to 24 V looked like a
    /// coil of more resistance.
    #[test]
    fn a_voltage_step_at_constant_duty_changes_no_ratio() {
        let mut rig = Rig::new();
        rig.supply_mv = 17_000;
        rig.driven([100.0, 0.0], 40);
        rig.supply_mv = 24_000;
        let old_ma = rig.currents_ma;
        for _ in 0..2 {
            rig.driven([100.0, 0.0], 1);
            rig.currents_ma = old_ma;
        }
        let scales = rig.driven([100.0, 0.0], 1);
        assert!((factor(scales.fill) / HOT - 1.0).abs() < 0.03, "{scales:?}");
    }

    /// Defect seen: a sensor that showed 15 V at 24 V made each coil look like 53 ohm, long after it had recovered.
    #[test]
    fn a_voltage_outside_its_window_measures_no_resistance() {
        let mut rig = Rig::new();
        rig.driven([80.0, 0.0], 20);
        let ratio = rig.resistances.fill.ratio;
        let currents_ma = rig.currents_ma;
        for _ in 0..100 {
            rig.supply_mv = 15_000;
            rig.currents_ma = currents_ma;
            rig.driven([80.0, 0.0], 1);
        }
        assert_eq!(rig.resistances.fill.ratio, ratio);
    }

    /// Defect seen in the fault campaign: an open coil looked like one of more resistance, and after the repair the pulses
    /// were too short for a measurement.
    #[test]
    fn a_current_outside_its_window_measures_no_resistance() {
        let mut rig = Rig::new();
        rig.driven([80.0, 0.0], 20);
        let ratio = rig.resistances.fill.ratio;
        for current_ma in [0, 14, 641, u16::MAX] {
            for _ in 0..100 {
                rig.currents_ma = [current_ma; 2];
                rig.driven([80.0, 0.0], 1);
            }
            assert_eq!(rig.resistances.fill.ratio, ratio, "{current_ma} mA");
        }
    }

    /// Defect seen in the fault campaign: with a shorted driver, a current of full duty looked like a coil of less
    /// resistance, long after the repair.
    #[test]
    fn a_confirmed_fault_of_a_coil_makes_the_resistances_unknown() {
        let unknown = Rig::new().driven([0.0; 2], 1);
        for fault in Fault::ALL {
            let mut rig = Rig::new();
            let hot = rig.driven([80.0, 80.0], 20);
            rig.faults = FaultSet::of(fault);
            let is_of_coil = COIL_FAULTS.contains(fault);
            let during = rig.driven([80.0, 80.0], 1);
            assert_eq!(during == unknown, is_of_coil, "{fault:?}");
            rig.driven([80.0, 80.0], 100);
            rig.faults = FaultSet::NONE;
            assert_eq!(rig.driven([0.0; 2], 1) == unknown, is_of_coil);
            rig.driven([80.0, 80.0], 20);
            let after = rig.driven([0.0; 2], 1);
            assert!((factor(after.fill) / factor(hot.fill) - 1.0).abs() < 0.03);
        }
    }

    #[test]
    fn a_voltage_that_is_not_plausible_leaves_the_ratio_and_counts_as_nominal() {
        let mut rig = Rig::new();
        rig.driven([80.0, 0.0], 20);
        rig.supply_mv = 0;
        rig.driven([80.0, 0.0], 100);
        let scales = rig.driven([80.0, 0.0], 1);
        assert!((factor(scales.fill) / HOT - 1.0).abs() < 0.03, "{scales:?}");
    }
}
