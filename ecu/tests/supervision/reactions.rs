//! Fault reactions: driven valves, durations and pressures.

use ecu::{EcuSettings, Fault, Inputs, Mode, SensorCode, VentValve, safe_outputs};

use crate::bench::{Bench, code};

const NO_PRESSURE: fn(&mut Inputs) = |inputs| inputs.pressure = None;
const NO_REFERENCE: fn(&mut Inputs) = |inputs| inputs.reference = None;
const LATE: fn(&mut Inputs) = |inputs| inputs.elapsed_us = 30_000;

#[test]
fn the_safe_state_is_no_current_in_either_coil() {
    let outputs = safe_outputs();
    assert!(outputs.duty_fill.is_off() && outputs.duty_vent.is_off());
}

#[test]
fn a_sample_that_is_not_believed_shuts_both_valves_at_once() {
    for (reference_bar, wrong) in [
        (8.0, NO_PRESSURE),
        (0.5, NO_PRESSURE),
        (8.0, |inputs| inputs.pressure = Some(code(10.3))),
    ] {
        let mut bench = Bench::at(4.0);
        bench.reference_bar = reference_bar;
        bench.steps(3);
        assert!(!bench.is_off());
        bench.step_with(wrong);
        assert!(bench.is_off());
        bench.step();
        assert!(!bench.is_off());
    }
}

#[test]
fn a_sample_without_reference_does_not_open_the_fill_valve_further() {
    let mut bench = Bench::at(1.0);
    bench.reference_bar = 3.0;
    bench.step();
    bench.step();
    for _ in 0..4 {
        let before = bench.duties()[0];
        bench.step_with(NO_REFERENCE);
        assert!(bench.duties()[0] <= before);
    }
    // The vent valve may still open.
    let mut bench = Bench::at(5.0);
    bench.reference_bar = 1.0;
    bench.step();
    bench.step_with(NO_REFERENCE);
    assert!(bench.duties()[1] > 0.0);
}

#[test]
fn holding_shuts_both_valves_for_50_samples_then_the_chamber_is_released_in_pulses() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(5, NO_PRESSURE);
    let before_bar = bench.rig.pressure_bar;
    assert_eq!(bench.stays_in(Mode::Holding, NO_PRESSURE), 50);
    assert_eq!(bench.ecu.mode(), Mode::Venting);
    let mut open = Vec::new();
    let mut samples = 0;
    while bench.ecu.mode() == Mode::Venting {
        assert_eq!(bench.duties()[0], 0.0);
        open.push(bench.duties()[1] == 100.0);
        assert!(open[samples] || bench.duties()[1] == 0.0);
        samples += 1;
        bench.step_with(NO_PRESSURE);
    }
    assert_eq!(samples, 800);
    for period in open.chunks(16) {
        let expected: Vec<bool> = (0..16).map(|sample| sample < 4).collect();
        assert_eq!(period, expected);
    }
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    assert!(bench.is_off());
    assert!(before_bar > 4.8 && bench.rig.pressure_bar < 0.01);
}

/// A sudden loss of braking torque is a hazard: pulses empty the chamber more slowly than full venting.
#[test]
fn a_release_in_pulses_takes_longer_than_venting_at_once() {
    let half_life = |mut bench: Bench, wrong: &dyn Fn(&mut Inputs)| {
        let mut samples = 0;
        while bench.rig.pressure_bar > 2.5 {
            bench.step_with(wrong);
            samples += 1;
        }
        samples
    };
    let released = half_life(Bench::at(5.0), &LATE);
    let mut stuck = Bench::at(5.0);
    stuck.reference_bar = 5.0;
    let vented = half_life(stuck, &|inputs| inputs.current_fill_ma = Some(900));
    assert!(vented < 20 && released > 30, "{vented}, {released}");
}

#[test]
fn a_ramp_leads_the_pressure_down_with_the_vent_valve_alone() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(5, NO_REFERENCE);
    let mut samples = 0;
    while bench.ecu.mode() == Mode::Ramping {
        assert_eq!(bench.duties()[0], 0.0);
        // 5 bar/s are 0.05 bar in a sample; the pressure is below by at most a sample of the vent valve and the
        // deadband.
        let led_bar = 5.0 - 0.05 * f64::from(samples);
        let below_bar = led_bar - bench.rig.pressure_bar;
        assert!(
            below_bar < 0.5 && below_bar > -0.5,
            "{samples}: {below_bar}"
        );
        samples += 1;
        bench.step_with(NO_REFERENCE);
    }
    assert!((95..=102).contains(&samples), "{samples}");
    assert_eq!(bench.ecu.mode(), Mode::Venting);
    let mut open = 0;
    while bench.ecu.mode() == Mode::Venting {
        assert_eq!(bench.duties(), [0.0, 100.0]);
        open += 1;
        bench.step_with(NO_REFERENCE);
    }
    assert_eq!(open, 200);
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    assert!(bench.is_off());
}

/// The ramp begins at the lower one of reference and pressure, so it never fills.
#[test]
fn a_ramp_begins_at_the_pressure_when_the_reference_is_above_it() {
    let mut bench = Bench::at(1.0);
    bench.reference_bar = 8.0;
    bench.steps(8);
    let before_bar = bench.rig.pressure_bar;
    bench.rig.fill_stuck_at = Some(0.0);
    bench.steps(12);
    assert_eq!(bench.ecu.mode(), Mode::Ramping);
    let samples = bench.stays_in(Mode::Ramping, |_| {});
    assert!(
        f64::from(samples) <= before_bar / 0.05 + 25.0,
        "{samples} from {before_bar} bar"
    );
}

#[test]
fn a_fault_that_asks_for_it_vents_for_200_samples_at_once() {
    let short: fn(&mut Inputs) = |inputs| inputs.current_fill_ma = Some(900);
    let mut bench = Bench::at(5.0);
    bench.steps_with(3, short);
    assert_eq!(bench.duties(), [0.0, 100.0]);
    assert_eq!(bench.stays_in(Mode::Venting, short), 200);
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    assert!(bench.is_off());
}

#[test]
fn what_is_released_in_pulses_is_vented_at_once_when_a_fault_asks_for_it() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(100, LATE);
    assert_eq!(bench.ecu.mode(), Mode::Venting);
    bench.steps_with(3, |inputs| inputs.current_fill_ma = Some(900));
    assert_eq!(bench.duties(), [0.0, 100.0]);
    // Full venting continues after that fault is over, and ends 200 samples after it began.
    assert_eq!(bench.stays_in(Mode::Venting, LATE), 200);
    assert_eq!(bench.ecu.mode(), Mode::Safe);
}

#[test]
fn a_vent_coil_that_cannot_be_trusted_is_left_without_current() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(3, |inputs| inputs.current_vent_ma = Some(900));
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    assert!(bench.is_off());
    // The bench's vent valve is normally closed: the pressure stays in the chamber.
    let before_bar = bench.rig.pressure_bar;
    bench.steps_with(1000, |inputs| inputs.current_vent_ma = Some(900));
    assert_eq!(bench.rig.pressure_bar, before_bar);
}

#[test]
fn without_a_sensor_a_ramp_becomes_a_release() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(20, NO_REFERENCE);
    assert_eq!(bench.ecu.mode(), Mode::Ramping);
    bench.steps_with(5, |inputs| {
        NO_REFERENCE(inputs);
        NO_PRESSURE(inputs);
    });
    assert_eq!(bench.ecu.mode(), Mode::Venting);
}

#[test]
fn a_ramp_that_lost_single_samples_of_the_sensor_shuts_the_valve_in_them() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(20, NO_REFERENCE);
    for _ in 0..10 {
        bench.step_with(|inputs| {
            NO_REFERENCE(inputs);
            inputs.pressure = Some(SensorCode::MIN);
        });
        assert!(bench.is_off());
        bench.steps_with(3, NO_REFERENCE);
        assert_eq!(bench.ecu.mode(), Mode::Ramping);
    }
}

#[test]
fn a_normally_open_vent_valve_empties_the_chamber_in_the_safe_state() {
    let settings = EcuSettings {
        vent_valve: VentValve::NormallyOpen,
        ..EcuSettings::bench()
    };
    let mut bench = Bench::with(&settings).settled_at(5.0);
    assert_eq!(bench.duties()[1], 100.0, "a current closes it");
    bench.steps_with(3, |inputs| inputs.current_vent_ma = Some(900));
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    assert!(bench.is_off());
    bench.steps_with(200, |inputs| inputs.current_vent_ma = Some(900));
    assert!(bench.rig.pressure_bar < 0.01, "{}", bench.rig.pressure_bar);
    assert!(bench.has(Fault::VentCoilShort));
}
