//! Rigs like those on which the diagnosis once failed, in five families: no hidden departure may lead to a wrong name.

use core::ops::ControlFlow;
use std::fmt::Write;

use model_lab::diagnosis::diagnose;
use model_lab::diagnosis::result::{Diagnosis, Verdict};
use plant_sim::PlantParameters;
use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::plant::VENT;
use plant_sim::valve::ValveFunction;
use retarder_tests::chance::Chance;
use retarder_tests::failed_rigs::{FailedRig, Interval, TestSignal, steps};
use retarder_tests::reference_plant::Departures;

/// Departure of a rig from its plant file, unknown to the diagnosis.
struct Hidden {
    hide: fn(&mut Departures),
    /// Effects of the library that are right names for it.
    names: &'static [&'static str],
    /// Whether the library has it.
    is_in_library: bool,
}

/// Chamber leak of 1.5 mg/s at 5 bar.
const fn leak(hide: fn(&mut Departures)) -> Hidden {
    Hidden {
        hide,
        names: &["chamber_leak"],
        is_in_library: true,
    }
}

const HOLE: Hidden = leak(|d| d.flow.chamber_leak.hole_m2 = 1.06e-9);
const GAP: Hidden = leak(|d| d.flow.chamber_leak.gap_kg_per_s_pa2 = 4.3e-18);
/// Law between laminar and orifice.
const ROUGH: Hidden = leak(|d| {
    d.flow.chamber_leak.rough_kg_per_s = 0.486e-6;
    d.flow.chamber_leak.rough_power = 0.7;
});
/// Heat to a wall of constant temperature.
const HEAT: Hidden = Hidden {
    hide: |d| d.chamber.thermal_s = 0.5,
    names: &["gas_temperature"],
    is_in_library: true,
};
/// Heat that grows with the density, to a wall that warms.
const WARM_WALL: Hidden = Hidden {
    hide: |d| {
        d.chamber.thermal_s = 0.5;
        d.chamber.thermal_density_power = 0.5;
        d.chamber.wall_j_per_k = 5.0;
        d.chamber.wall_s = 20.0;
    },
    ..HEAT
};
const LAG: Hidden = Hidden {
    hide: |d| d.sensor.lag_s = 20e-3,
    names: &["sensor_lag", "dead_volume"],
    is_in_library: true,
};
/// Volume that creeps after the pressure, 1 % per bar.
const HOSE: Hidden = Hidden {
    hide: |d| {
        d.chamber.hose_per_pa = 1e-7;
        d.chamber.hose_s = 0.5;
    },
    names: &["regulating_valve_volume"],
    is_in_library: true,
};
/// Second chamber of 300 cm³ behind an orifice of 1 mm².
const SECOND_CHAMBER: Hidden = Hidden {
    hide: |d| {
        d.chamber.cavity_m3 = 300e-6;
        d.chamber.cavity_m2 = 1e-6;
    },
    names: &["dead_volume"],
    is_in_library: true,
};
/// Critical ratio of 0.35.
const CRITICAL_RATIO: Hidden = Hidden {
    hide: |d| d.flow.critical_ratio_drop = RATIO_DROP,
    names: &["critical_ratio"],
    is_in_library: true,
};
/// Critical ratio of an ideal nozzle less that of the hidden law.
const RATIO_DROP: f64 = 0.528 - 0.35;

/// Case of the table.
struct Case<'a> {
    rig: FailedRig,
    hidden: &'a [Hidden],
    /// Effects that the logs show so clearly that each has to be named.
    clear: &'a [&'a str],
}

impl Case<'_> {
    /// Diagnoses the rig and checks the answer against the physics.
    fn check(mut self) {
        for hidden in self.hidden {
            (hidden.hide)(&mut self.rig.rig.departures);
        }
        let [fit, check] = self.rig.logs();
        let watch = |_| ControlFlow::Continue(());
        let diagnosis = diagnose(&self.rig.file, &[fit], &[check], &watch).unwrap();
        let problems = self.problems(&diagnosis);
        assert!(
            problems.is_empty(),
            "{}\n{}",
            problems.join("\n"),
            summary(&diagnosis)
        );
    }

    fn problems(&self, diagnosis: &Diagnosis) -> Vec<String> {
        let right: Vec<&str> = self
            .hidden
            .iter()
            .flat_map(|hidden| hidden.names)
            .copied()
            .collect();
        let named = |name: &str| diagnosis.effects.iter().any(|effect| effect == name);
        let wrong = diagnosis.effects.iter();
        let wrong = wrong.filter(|effect| !right.contains(&effect.as_str()));
        let missing = self.clear.iter().filter(|name| !named(name));
        let mut problems: Vec<String> = wrong
            .map(|name| format!("{name} is a wrong name"))
            .chain(missing.map(|name| format!("{name} is not named")))
            .collect();
        if !self.verdicts().contains(&diagnosis.verdict) {
            problems.push(format!("{:?} is a wrong verdict", diagnosis.verdict));
        }
        problems
    }

    /// Returns the verdicts that are right.
    fn verdicts(&self) -> Vec<Verdict> {
        if self.hidden.is_empty() {
            return vec![Verdict::Adequate, Verdict::PlantFileWrong];
        }
        let mut verdicts = vec![Verdict::Found, Verdict::FormWrong];
        if self.clear.is_empty() {
            verdicts.push(Verdict::Adequate);
        }
        if self.hidden.iter().any(|hidden| !hidden.is_in_library) {
            verdicts.push(Verdict::NotInLibrary);
        }
        verdicts
    }
}

/// Returns the parts of a diagnosis that a failed test shows.
fn summary(diagnosis: &Diagnosis) -> String {
    let mut text = format!("{:?}: {}\n", diagnosis.verdict, diagnosis.sentence);
    for step in &diagnosis.error_steps {
        let (name, share) = (step.name(), step.explained_share);
        _ = write!(text, "{name}: explains {share:.3};");
        for signal in step.check_rms.keys() {
            _ = write!(text, " {signal} {:.2} noise floors", step.in_noise(signal));
        }
        text.push('\n');
    }
    for value in &diagnosis.outside {
        _ = writeln!(text, "outside: {value}");
    }
    let cost = &diagnosis.cost;
    _ = write!(
        text,
        "{} simulations, {:.1} s",
        cost.simulations, cost.elapsed_s
    );
    text
}

/// Returns a closed tank of 100 cm³, filled fast and logged from 3 s later on, at 50 Hz.
fn tank(noise_mbar: f64) -> FailedRig {
    let mut file = PlantParameters::nominal();
    file.chamber.volume_m3 = 100e-6;
    let mut rig = FailedRig::of(file, 1);
    rig.file.functions = [ValveFunction::Absent; 2];
    rig.signals = [(0.14, 25.0), (0.08, 20.0)].map(|(fill_s, logged_s)| TestSignal {
        before: vec![(fill_s, 100.0, 0.0), (3.0, 0.0, 0.0)],
        logged: vec![(logged_s, 0.0, 0.0)],
    });
    rig.noise_bar = 1e-3 * noise_mbar;
    rig.samples_per_row = 2;
    rig
}

/// Returns the test signals of a rig with two valves.
fn signals(logged: [Vec<Interval>; 2]) -> [TestSignal; 2] {
    logged.map(|logged| TestSignal {
        before: Vec::new(),
        logged,
    })
}

/// Returns test signals of 15 s and 10 s.
fn ordinary_signals(longer: f64, seed: u64) -> [TestSignal; 2] {
    let mut chance = Chance::new(seed);
    signals([15.0, 10.0].map(|length_s| steps(length_s, longer, &mut chance)))
}

/// Returns the bundled rig, filled within 0.1 s and held.
fn hold(noise_mbar: f64, hold_s: f64) -> FailedRig {
    let mut rig = FailedRig::of(PlantParameters::nominal(), 2);
    let mut chance = Chance::new(2);
    rig.signals = signals(
        [(0.1, hold_s), (0.07, 0.5 * hold_s)].map(|(fill_s, hold_s)| {
            let mut signal = vec![
                (0.5, 0.0, 0.0),
                (fill_s, 100.0, 0.0),
                (hold_s, 0.0, 0.0),
                (1.0, 0.0, 100.0),
            ];
            signal.extend(steps(4.0, 1.0, &mut chance));
            signal
        }),
    );
    rig.noise_bar = 1e-3 * noise_mbar;
    rig
}

/// Returns the bundled rig with a wrong orifice.
fn wrong_orifice(noise_mbar: f64, has_currents: bool, change: fn(&mut FailedRig)) -> FailedRig {
    let mut rig = FailedRig::of(PlantParameters::nominal(), 4);
    rig.signals = ordinary_signals(1.0, 4);
    rig.noise_bar = 1e-3 * noise_mbar;
    rig.has_currents = has_currents;
    change(&mut rig);
    rig
}

/// Returns two chambers of 300 cm³ at 6 bar, with a normally open vent valve and a critical ratio of 0.35, which the
/// plant file contains.
fn two_chambers() -> FailedRig {
    let mut rig = chambers_of_file(2.0, 20.0);
    let effect = by_id("critical_ratio").unwrap();
    let ellipse = effect.about().variant("iso6358").unwrap();
    let setting = EffectSetting::typical_variant(effect, ellipse).with("reduction", RATIO_DROP);
    rig.file = rig.file.with_effect(setting);
    (CRITICAL_RATIO.hide)(&mut rig.rig.departures);
    rig
}

/// Returns `count` such chambers with the critical ratio of an ideal nozzle, and the currents of their valves.
fn chambers_with_currents(count: f64, pwm_hz: f64) -> FailedRig {
    FailedRig {
        has_currents: true,
        ..chambers_of_file(count, pwm_hz)
    }
}

/// Returns `count` such chambers with the critical ratio of an ideal nozzle.
fn chambers_of_file(count: f64, pwm_hz: f64) -> FailedRig {
    let mut file = PlantParameters::nominal();
    file.chamber.volume_m3 = 300e-6 * count;
    file.gas.supply_pressure_bar_gauge = 6.0;
    file.ecu.pwm_frequency_hz = pwm_hz;
    file.functions[VENT] = ValveFunction::NormallyOpen;
    file.armature.preload_vent_n = 1.4;
    let mut rig = FailedRig::of(file, 5);
    rig.signals = ordinary_signals(6.0, 5);
    // The log begins anywhere in the pattern of samples and PWM periods.
    rig.signals[0].before = vec![(0.02, 0.0, 100.0)];
    rig
}

/// Returns the bundled rig.
fn bench(noise_mbar: f64, has_currents: bool) -> FailedRig {
    let mut rig = FailedRig::of(PlantParameters::nominal(), 6);
    rig.signals = ordinary_signals(1.0, 6);
    rig.noise_bar = 1e-3 * noise_mbar;
    rig.has_currents = has_currents;
    rig
}

macro_rules! cases {
    ($($name:ident: $rig:expr, $hidden:expr, $clear:expr;)*) => { $(
        #[test]
        fn $name() {
            let case = Case { rig: $rig, hidden: &$hidden, clear: &$clear };
            case.check();
        }
    )* };
}

cases! {
    tank_with_a_rough_leak_and_heat_at_0_07_mbar: tank(0.07), [ROUGH, HEAT], ["chamber_leak"];
    tank_with_a_rough_leak_and_heat_at_0_7_mbar: tank(0.7), [ROUGH, HEAT], ["chamber_leak"];
    tank_with_a_rough_leak_at_3_mbar: tank(3.0), [ROUGH], ["chamber_leak"];
    tank_with_a_gap_and_a_warm_wall_at_0_07_mbar: tank(0.07), [GAP, WARM_WALL], ["chamber_leak"];
    tank_with_a_hole_at_0_07_mbar: tank(0.07), [HOLE], ["chamber_leak"];
    tank_that_is_tight_with_heat_at_0_07_mbar: tank(0.07), [HEAT], [];

    hold_of_15_s_with_a_warm_wall_at_3_mbar: hold(3.0, 15.0), [WARM_WALL], ["gas_temperature"];
    hold_of_60_s_with_nothing_hidden: hold(0.7, 60.0), [], [];
    hold_of_60_s_with_heat: hold(0.7, 60.0), [HEAT], ["gas_temperature"];

    vent_orifice_12_percent_larger_with_currents:
        wrong_orifice(0.7, true, |rig| rig.rig.datasheet.flow.discharge_vent = 1.12 * 0.97), [], [];
    vent_orifice_12_percent_wider_without_currents:
        wrong_orifice(3.0, false, |rig| rig.rig.datasheet.flow.orifice_vent_m = 1.12 * 1.9e-3), [], [];
    vent_orifice_12_percent_smaller_at_0_07_mbar:
        wrong_orifice(0.07, false, |rig| rig.rig.datasheet.flow.discharge_vent = 0.88 * 0.97), [], [];

    fill_orifice_12_percent_narrower_with_currents:
        wrong_orifice(0.7, true, |rig| rig.rig.datasheet.flow.orifice_fill_m = 0.88 * 1.9e-3), [], [];

    chambers_of_600_cm3_with_20_hz_pwm_and_nothing_hidden: two_chambers(), [], [];
    critical_ratio_with_20_hz_pwm_and_mean_currents:
        chambers_with_currents(2.0, 20.0), [CRITICAL_RATIO], ["critical_ratio"];
    second_chamber_with_20_hz_pwm_and_mean_currents:
        chambers_with_currents(1.0, 20.0), [SECOND_CHAMBER], ["dead_volume"];
    second_chamber_and_critical_ratio:
        chambers_of_file(1.0, 100.0), [SECOND_CHAMBER, CRITICAL_RATIO], ["dead_volume", "critical_ratio"];

    sensor_lag_with_currents: bench(0.7, true), [LAG], [];
    sensor_lag_at_3_mbar: bench(3.0, false), [LAG], [];
    hose_behind_a_sensor_lag: bench(0.7, true), [HOSE, LAG], [];
    hose_behind_a_sensor_lag_at_0_07_mbar:
        bench(0.07, false), [HOSE, LAG], ["regulating_valve_volume", "sensor_lag"];
}
