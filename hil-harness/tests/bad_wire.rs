//! Loop whose frames are lost, damaged, repeated, late and out of order: the same bits, and each disturbance is
//! counted.

use std::time::Duration;

use hil_harness::ecu_under_test::{EcuUnderTest, ecu_in_process};
use hil_harness::image_log::ImageLog;
use hil_harness::link::{Disturbed, Framed, Link, LinkError, Loopback, Pace, Patience};
use hil_harness::{DutError, ReferenceProfile, RunError, Scenario, run, run_in_process};
use hil_protocol::{Reply, Request};

fn patience(tries: u32) -> Patience {
    Patience {
        reply: Duration::from_millis(1),
        tries,
        start: Duration::from_secs(10),
    }
}

fn scenario() -> Scenario {
    let steps = ReferenceProfile::starting_at(0.0)
        .step_to(3.0)
        .hold_ms(4000);
    Scenario::new("up and down", steps.step_to(1.0).hold_ms(4000))
}

#[test]
fn frames_that_are_lost_damaged_repeated_or_late_change_no_bit_and_are_counted() {
    let wire = Disturbed::new(Loopback::new(ecu_in_process()), 7, 40);
    let framed = Framed::open(
        wire,
        Pace::LockStep,
        patience(20),
        ImageLog::without_texts(),
    );
    let mut device = EcuUnderTest::at(framed.unwrap());
    let run = run(&scenario(), &mut device).unwrap();
    assert!(run.device.ends_with("disturbed"), "{}", run.device);
    assert_eq!(
        run.exchanges,
        run_in_process(&scenario()).unwrap().exchanges
    );

    let link = device.link_mut();
    for direction in link.transport().disturbances() {
        let counts = [
            direction.lost,
            direction.damaged,
            direction.repeated,
            direction.late,
        ];
        assert!(counts.iter().all(|count| *count >= 5), "{direction:?}");
    }
    let Reply::Counters(at_device) = link.ask(&Request::Counters).unwrap() else {
        panic!("counters");
    };
    let [to_device, to_host] = link.transport().disturbances();
    let at_host = link.counters();
    // A flipped delimiter makes one damaged frame of two, so some are not counted separately.
    assert!(at_device.corrupt >= to_device.damaged / 2 && at_host.corrupt >= to_host.damaged / 2);
    // The second of two answers may come after the next request.
    assert!(at_device.duplicate >= to_device.repeated);
    assert!(
        at_host.duplicate + at_host.stale >= to_host.repeated,
        "{at_host:?}"
    );
    assert!(
        at_device.stale > 0 && at_host.stale > 0,
        "{at_device:?} {at_host:?}"
    );
    assert!(
        at_host.repeated >= to_device.lost + to_host.lost,
        "{at_host:?}"
    );
}

#[test]
fn frames_on_a_good_wire_carry_the_same_bits_as_none() {
    let wire = Loopback::new(ecu_in_process());
    let framed = Framed::open(wire, Pace::LockStep, patience(3), ImageLog::without_texts());
    let mut device = EcuUnderTest::at(framed.unwrap());
    let run = run(&scenario(), &mut device).unwrap();
    assert_eq!(
        run.exchanges,
        run_in_process(&scenario()).unwrap().exchanges
    );
    assert_eq!(device.link().counters().repeated, 0);
}

#[test]
fn a_wire_that_loses_everything_is_an_error_after_so_many_tries() {
    let wire = Disturbed::new(Loopback::new(ecu_in_process()), 7, 40);
    let mut framed =
        Framed::open(wire, Pace::LockStep, patience(5), ImageLog::without_texts()).unwrap();
    *framed.transport_mut() = Disturbed::new(Loopback::new(ecu_in_process()), 7, 1);
    let error = framed.ask(&Request::Counters).unwrap_err();
    assert!(
        matches!(error, LinkError::Silent { tries: 5, .. }),
        "{error}"
    );
}

/// Invalid settings end the run before a frame is sent, with an error of the settings.
#[test]
fn settings_out_of_bounds_end_the_run_before_a_frame_is_sent() {
    let mut scenario = scenario();
    scenario.controller.gain_pct_per_bar = (-1_i16).into();
    let Err(RunError::Device { error, .. }) = run_in_process(&scenario) else {
        panic!("a negative gain");
    };
    assert!(matches!(*error, DutError::Settings(_)), "{error}");
}
