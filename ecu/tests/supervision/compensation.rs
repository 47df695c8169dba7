//! Duty limits and open duty cycles that follow supply voltage and coil resistance.

use controller::Settings;
use ecu::{EcuSettings, Fault, Mode};

use crate::bench::Bench;

/// Returns the fill valve's duty cycle (%) in the first sample after a step to 6 bar, at this supply voltage.
fn first_duty(settings: &EcuSettings, supply_mv: u16) -> f64 {
    let mut bench = Bench::with(settings);
    for _ in 0..20 {
        bench.step_with(|inputs| inputs.battery_mv = Some(supply_mv));
    }
    assert_eq!(bench.ecu.mode(), Mode::Running);
    bench.reference_bar = 6.0;
    bench.step_with(|inputs| inputs.battery_mv = Some(supply_mv));
    bench.duties()[0]
}

/// 82 % is the upper limit at 24 V.
#[test]
fn a_duty_limit_is_inversely_proportional_to_the_supply_voltage() {
    for (supply_mv, expected_pct) in [
        (18_000, 100.0),
        (24_000, 82.0),
        (28_000, 70.3),
        (32_000, 61.5),
    ] {
        let found = first_duty(&EcuSettings::bench(), supply_mv);
        assert!(
            (found - expected_pct).abs() < 0.1,
            "{supply_mv} mV: {found} %"
        );
    }
}

#[test]
fn the_thesis_controller_has_the_same_limits_at_every_voltage() {
    let settings = EcuSettings {
        controller: Settings::thesis(),
        ..EcuSettings::bench()
    };
    for supply_mv in [18_000, 24_000, 32_000] {
        assert_eq!(first_duty(&settings, supply_mv), 82.0, "{supply_mv} mV");
    }
}

/// The sensor of the supply voltage fails: the loop goes on with the limits of the nominal voltage until N samples
/// confirm the fault.
#[test]
fn a_supply_voltage_of_zero_counts_as_nominal_and_is_reported() {
    let mut bench = Bench::at(2.0);
    bench.reference_bar = 6.0;
    bench.step_with(|inputs| inputs.battery_mv = Some(0));
    let duty = bench.duties()[0];
    assert!((duty - 82.0).abs() < 2.0, "{duty} %");
    bench.steps_with(9, |inputs| inputs.battery_mv = Some(0));
    assert_eq!(bench.ecu.faults().to_string(), "BatteryLow");
    assert_eq!(bench.ecu.mode(), Mode::Holding);
}

/// At 18 V, a coil of 120 °C has 54 % of its current: not even full duty opens the valve for certain, so a pressure that
/// does not fall is no fault of the valve.
#[test]
fn a_vent_valve_without_enough_current_gives_no_false_alarm() {
    let mut bench = Bench::at(5.0);
    bench.reference_bar = 0.0;
    bench.rig.vent_stuck_at = Some(0.0);
    for _ in 0..100 {
        bench.step_with(|inputs| {
            let hot = |current_ma: u16| (f64::from(current_ma) * 18.0 / 24.0 / 1.39) as u16;
            inputs.current_fill_ma = inputs.current_fill_ma.map(hot);
            inputs.current_vent_ma = inputs.current_vent_ma.map(hot);
            inputs.battery_mv = Some(18_000);
        });
    }
    assert!(!bench.has(Fault::NoFall), "{}", bench.ecu.faults());
    let mut sound = Bench::at(5.0);
    sound.reference_bar = 0.0;
    sound.rig.vent_stuck_at = Some(0.0);
    sound.steps(100);
    assert!(sound.has(Fault::NoFall), "{}", sound.ecu.faults());
}
