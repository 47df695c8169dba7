//! Resets: the chamber is not filled until the reference was zero.

use ecu::{Ecu, EcuConfig, EcuSettings, Mode, ResetCause, VentValve};

use crate::bench::Bench;

/// Returns a bench after a reset with a full chamber, while the driver still asks for 5 bar.
fn reset_while_braking(cause: ResetCause) -> Bench {
    let before = Bench::at(5.0);
    let config = EcuConfig::new(&EcuSettings::bench()).unwrap();
    let mut bench = Bench::of(Ecu::new(config, cause), VentValve::NormallyClosed);
    bench.rig = before.rig;
    bench.reference_bar = 5.0;
    bench
}

#[test]
fn whatever_the_cause_nothing_is_filled_before_the_reference_was_at_zero() {
    for cause in [
        ResetCause::PowerOn,
        ResetCause::Watchdog,
        ResetCause::Brownout,
        ResetCause::Panic,
    ] {
        let mut bench = reset_while_braking(cause);
        assert_eq!(bench.ecu.reset_cause(), cause);
        bench.rig.pressure_bar = 2.0;
        for _ in 0..1000 {
            bench.step();
            assert_eq!(bench.duties()[0], 0.0);
            assert_eq!(bench.ecu.mode(), Mode::Waiting);
        }
    }
}

#[test]
fn while_it_waits_the_vent_valve_follows_the_reference_down() {
    let mut bench = reset_while_braking(ResetCause::Watchdog);
    bench.steps(100);
    assert!(
        (bench.rig.pressure_bar - 5.0).abs() < 0.1,
        "nothing is asked to change"
    );
    bench.reference_bar = 2.0;
    bench.steps(200);
    assert!(
        (bench.rig.pressure_bar - 2.0).abs() < 0.2,
        "{}",
        bench.rig.pressure_bar
    );
    assert_eq!(bench.ecu.mode(), Mode::Waiting);
}

/// The controller vents while the ECU waits, and continues when running begins.
#[test]
fn a_chamber_that_is_emptied_while_it_waits_is_not_filled_when_running_begins() {
    let mut bench = reset_while_braking(ResetCause::Watchdog);
    bench.steps(20);
    bench.reference_bar = 0.0;
    let mut began_at_bar = None;
    for _ in 0..200 {
        bench.step();
        assert_eq!(bench.duties()[0], 0.0, "{} bar", bench.rig.pressure_bar);
        if bench.ecu.mode() == Mode::Running {
            began_at_bar.get_or_insert(bench.rig.pressure_bar);
        }
    }
    assert!(began_at_bar.unwrap() > 1.0, "{began_at_bar:?}");
    assert!(bench.rig.pressure_bar < 0.1);
}

#[test]
fn ten_samples_of_zero_begin_running_and_nine_do_not() {
    for (samples, expected) in [(9, Mode::Waiting), (10, Mode::Running), (11, Mode::Running)] {
        let mut bench = Bench::new();
        bench.steps(samples);
        assert_eq!(bench.ecu.mode(), expected, "{samples}");
    }
    for (reference_bar, expected) in [
        (0.05, Mode::Running),
        (0.051, Mode::Waiting),
        (-0.5, Mode::Running),
    ] {
        let mut bench = Bench::new();
        bench.reference_bar = reference_bar;
        bench.steps(30);
        assert_eq!(bench.ecu.mode(), expected, "{reference_bar} bar");
    }
}

#[test]
fn the_samples_of_zero_are_in_a_row() {
    let mut bench = Bench::new();
    for _ in 0..50 {
        bench.reference_bar = 0.0;
        bench.steps(9);
        bench.reference_bar = 1.0;
        bench.step();
    }
    assert_eq!(bench.ecu.mode(), Mode::Waiting);
}

#[test]
fn a_sample_without_reference_is_no_zero_and_five_of_them_forget_the_zeros() {
    for (missing, expected) in [(4, Mode::Running), (5, Mode::Venting)] {
        let mut bench = Bench::new();
        bench.steps(9);
        bench.steps_with(missing, |inputs| inputs.reference = None);
        assert_ne!(bench.ecu.mode(), Mode::Running);
        bench.step();
        assert_eq!(bench.ecu.mode(), expected, "{missing}");
    }
}

#[test]
fn a_fault_while_it_waits_leads_back_to_waiting() {
    let mut bench = Bench::new();
    bench.reference_bar = 3.0;
    bench.steps(20);
    bench.steps_with(10, |inputs| inputs.pressure = None);
    assert_eq!(bench.ecu.mode(), Mode::Holding);
    for _ in 0..100 {
        bench.step();
        assert_eq!(bench.duties()[0], 0.0);
    }
    assert_eq!(bench.ecu.mode(), Mode::Waiting);
}
