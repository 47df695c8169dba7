//! Settings, telemetry and other interfaces of a sample.

use ecu::controller::Distributor;
use ecu::controller::fixed::types::I16F16;
use ecu::{Ecu, EcuConfig, EcuSettings, Mode, ResetCause};

use crate::bench::Bench;

fn with_gain(gain: i32) -> EcuConfig {
    let mut settings = EcuSettings::bench();
    settings.controller.gain_pct_per_bar = I16F16::from_num(gain);
    EcuConfig::new(&settings).unwrap()
}

#[test]
fn other_settings_take_effect_with_the_next_sample_and_the_old_ones_again_leave_no_bump() {
    let mut bench = Bench::at(1.0);
    bench.reference_bar = 5.0;
    bench.steps(5);
    let [as_before, the_same, others] = [None, Some(35), Some(60)].map(|gain| {
        let mut bench = bench.clone();
        if let Some(gain) = gain {
            bench.ecu.retune(with_gain(gain));
        }
        bench.step();
        let control_signal = bench.ecu.telemetry().control_signal;
        bench.steps(300);
        assert_eq!(bench.ecu.mode(), Mode::Running);
        assert!((bench.rig.pressure_bar - 5.0).abs() < 0.1);
        control_signal
    });
    // Within 2 % of 409 600.
    assert!(
        (the_same - as_before).abs() < 8192,
        "{the_same} instead of {as_before}"
    );
    assert_ne!(others, as_before);
}

/// The pressure is constant, so that only the settings can change the control signal.
#[test]
fn another_gain_does_not_move_the_control_signal() {
    let mut bench = Bench::at(3.0);
    bench.reference_bar = 3.3;
    bench.rig.fill_stuck_at = Some(0.0);
    bench.steps(6);
    let before = bench.ecu.telemetry().control_signal;
    assert!(before > 20_480, "{before}");
    bench.ecu.retune(with_gain(60));
    bench.step();
    let after = bench.ecu.telemetry().control_signal;
    // Within 2 % of 409 600; 25 %/bar more of 0.3 bar would be 7.5 %.
    assert!((after - before).abs() < 8192, "{before} to {after}");
}

#[test]
fn a_controller_that_was_set_up_to_may_drive_both_valves() {
    let mut settings = EcuSettings::bench();
    settings.controller.distributor = Distributor::Scheme2 {
        middle_fill_pct: I16F16::from_num(60),
        middle_vent_pct: I16F16::from_num(60),
    };
    let mut bench = Bench::with(&settings);
    bench.steps(20);
    bench.reference_bar = 5.0;
    let mut both = 0;
    for _ in 0..100 {
        bench.step();
        both += u32::from(bench.duties().iter().all(|&duty| duty > 0.0));
    }
    assert!(both > 0);
    assert_ne!(bench.ecu.mode(), Mode::Locked);
}

#[test]
fn telemetry_contains_mode_faults_signal_and_state() {
    let mut bench = Bench::at(1.0);
    bench.reference_bar = 5.0;
    bench.step();
    let running = bench.ecu.telemetry();
    assert_eq!((running.mode, running.faults), (Mode::Running as u8, 0));
    assert!(running.control_signal > 0);
    assert_ne!(running.controller_state, [0; 6]);
    bench.steps_with(6, |inputs| inputs.pressure = None);
    let holding = bench.ecu.telemetry();
    assert_eq!(holding.mode, Mode::Holding as u8);
    assert_eq!(holding.faults, bench.ecu.faults().bits());
    assert_eq!(holding.control_signal, 0);
}

/// Two ECUs with the same inputs are equal to the last bit; one changed bit in one sample changes the digest.
#[test]
fn the_digest_is_that_of_everything_a_sample_leaves() {
    let mut bench = Bench::at(3.0);
    let mut other = bench.clone();
    for _ in 0..50 {
        bench.step();
        other.step();
        assert_eq!(bench.ecu.telemetry(), other.ecu.telemetry());
    }
    type Change = fn(&mut ecu::Inputs);
    let changes: [Change; 5] = [
        |inputs| inputs.pressure = None,
        |inputs| inputs.reference = None,
        |inputs| inputs.battery_mv = Some(0),
        |inputs| inputs.elapsed_us = 0,
        |inputs| inputs.current_vent_ma = Some(u16::MAX),
    ];
    for change in changes {
        let mut changed = bench.clone();
        changed.step_with(change);
        let mut same = bench.clone();
        same.step();
        assert_ne!(
            changed.ecu.telemetry().ecu_digest,
            same.ecu.telemetry().ecu_digest
        );
    }
}

#[test]
fn a_new_ecu_reports_its_mode_and_cause() {
    let config = EcuConfig::new(&EcuSettings::bench()).unwrap();
    let ecu = Ecu::new(config, ResetCause::Brownout);
    assert_eq!(ecu.mode(), Mode::Waiting);
    assert_eq!(ecu.reset_cause(), ResetCause::Brownout);
    assert!(ecu.faults().is_empty());
}
