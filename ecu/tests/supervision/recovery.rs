//! Recovery after a fault: return to control, number of retries, release of a lock.

use ecu::{Fault, Inputs, Mode, ReleaseRefused};

use crate::bench::Bench;

const NO_PRESSURE: fn(&mut Inputs) = |inputs| inputs.pressure = None;
const NO_REFERENCE: fn(&mut Inputs) = |inputs| inputs.reference = None;
const LATE: fn(&mut Inputs) = |inputs| inputs.elapsed_us = 30_000;
const FILL_SHORT: fn(&mut Inputs) = |inputs| inputs.current_fill_ma = Some(900);

/// Five good samples clear the fault. The loop runs again in the tenth sample without it, counting the one that cleared
/// it.
#[test]
fn a_fault_that_is_gone_for_ten_samples_is_over_and_not_before() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(10, NO_PRESSURE);
    bench.steps(4 + 9);
    assert_eq!(bench.ecu.mode(), Mode::Holding);
    bench.step();
    assert_eq!(bench.ecu.mode(), Mode::Running);
    assert!(bench.ecu.faults().is_empty());
}

#[test]
fn a_fault_that_comes_back_within_ten_samples_was_never_gone() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(10, NO_PRESSURE);
    bench.steps(4 + 9 - 5);
    bench.steps_with(5, NO_PRESSURE);
    bench.steps(4 + 9);
    assert_eq!(bench.ecu.mode(), Mode::Holding);
}

/// While both valves were shut the pressure leaked away: the loop continues from the present pressure and rises no
/// faster than the ramp.
#[test]
fn the_loop_comes_back_without_a_bump() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(6, NO_PRESSURE);
    bench.rig.pressure_bar = 4.0;
    while bench.ecu.mode() != Mode::Running {
        bench.step();
        assert!(bench.is_off(), "{:?}", bench.duties());
    }
    assert!(
        bench.is_off(),
        "the first sample asks for the pressure that is there"
    );
    let from_bar = bench.rig.pressure_bar;
    for sample in 1..200 {
        bench.step();
        let led_bar = (from_bar + 0.05 * f64::from(sample)).min(5.0);
        assert!(
            bench.rig.pressure_bar < led_bar + 0.25,
            "{sample}: {} bar",
            bench.rig.pressure_bar
        );
    }
    assert!((bench.rig.pressure_bar - 5.0).abs() < 0.1);
    // From here the reference is followed at once again.
    bench.reference_bar = 7.0;
    bench.steps(30);
    assert!(bench.rig.pressure_bar > 6.0, "{}", bench.rig.pressure_bar);
}

/// The reference fell below the pressure while both valves were shut: the loop vents, and fills nothing.
#[test]
fn the_loop_comes_back_below_the_pressure_without_a_sample_of_filling() {
    for reference_bar in [4.5, 3.0, 1.0] {
        let mut bench = Bench::at(5.0);
        bench.steps_with(6, NO_PRESSURE);
        bench.reference_bar = reference_bar;
        bench.steps(14);
        assert_eq!(bench.ecu.mode(), Mode::Running);
        while bench.rig.pressure_bar > reference_bar + 0.2 {
            assert_eq!(bench.duties()[0], 0.0, "{reference_bar} bar");
            bench.step();
        }
    }
}

#[test]
fn a_ramp_that_is_interrupted_goes_back_up() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(40, NO_REFERENCE);
    assert_eq!(bench.ecu.mode(), Mode::Ramping);
    let low_bar = bench.rig.pressure_bar;
    assert!(low_bar < 4.0);
    bench.steps(14);
    assert_eq!(bench.ecu.mode(), Mode::Running);
    bench.steps(200);
    assert!((bench.rig.pressure_bar - 5.0).abs() < 0.1);
}

#[test]
fn after_the_safe_state_the_reference_has_to_be_at_zero_first() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(300, FILL_SHORT);
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    bench.steps(2 + 9);
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    bench.step();
    assert_eq!(bench.ecu.mode(), Mode::Waiting);
    assert!(
        bench.has(Fault::FillCoilShort),
        "it is reported until running begins"
    );
    for _ in 0..1000 {
        bench.step();
        assert_eq!(bench.duties()[0], 0.0);
        assert_eq!(bench.ecu.mode(), Mode::Waiting);
    }
    bench.reference_bar = 0.0;
    bench.steps(9);
    assert_eq!(bench.ecu.mode(), Mode::Waiting);
    bench.step();
    assert_eq!(bench.ecu.mode(), Mode::Running);
    assert!(bench.ecu.faults().is_empty());
}

/// The chamber was still full when the time for emptying it was over: the next attempt begins automatically.
#[test]
fn a_vent_valve_that_comes_free_again_empties_the_chamber_after_all() {
    let mut bench = Bench::at(5.0);
    bench.reference_bar = 0.0;
    bench.rig.vent_stuck_at = Some(0.0);
    bench.steps(20);
    assert!(bench.has(Fault::NoFall));
    bench.steps(250);
    assert_eq!(bench.ecu.mode(), Mode::Safe);
    assert!(bench.has(Fault::SensorOffset), "as far as anybody can tell");
    bench.rig.vent_stuck_at = None;
    bench.steps(300);
    assert_eq!(bench.ecu.mode(), Mode::Running);
    assert!(bench.rig.pressure_bar < 0.1, "{}", bench.rig.pressure_bar);
}

/// The fault is gone before the chamber is empty: venting still takes its 200 samples and ends in `Safe`.
#[test]
fn a_fault_that_comes_while_the_chamber_is_emptied_does_not_stop_that() {
    let mut bench = Bench::at(5.0);
    bench.steps_with(3, FILL_SHORT);
    bench.steps(50);
    assert_eq!(bench.ecu.mode(), Mode::Venting);
    assert_eq!(bench.stays_in(Mode::Venting, |_| {}), 150);
    assert_eq!(bench.ecu.mode(), Mode::Safe);
}

fn interrupted(bench: &mut Bench) {
    bench.steps_with(6, NO_PRESSURE);
    assert_ne!(bench.ecu.mode(), Mode::Running);
    bench.steps(20);
}

#[test]
fn three_faults_are_survived_and_the_fourth_locks() {
    let mut bench = Bench::at(5.0);
    for _ in 0..3 {
        interrupted(&mut bench);
        assert_eq!(bench.ecu.mode(), Mode::Running);
        bench.steps(100);
    }
    interrupted(&mut bench);
    assert_eq!(bench.ecu.mode(), Mode::Holding, "it does not recover");
    while bench.ecu.mode() != Mode::Locked {
        assert!(matches!(bench.ecu.mode(), Mode::Holding | Mode::Venting));
        bench.step();
    }
    assert!(bench.is_off());
    assert!(bench.rig.pressure_bar < 0.01);
    bench.reference_bar = 0.0;
    bench.steps(1000);
    assert_eq!(bench.ecu.mode(), Mode::Locked);
    assert!(bench.is_off());
}

/// Counts the samples of running since the last fault, except the one in which running began.
#[test]
fn after_6000_healthy_samples_the_retries_begin_anew_and_not_before() {
    for (healthy, expected) in [(5999, Mode::Holding), (6000, Mode::Running)] {
        let mut bench = Bench::at(5.0);
        for _ in 0..3 {
            interrupted(&mut bench);
        }
        while bench.ecu.mode() != Mode::Running {
            bench.step();
        }
        // `interrupted` already ran for this many of its twenty samples.
        let already = 20 - (4 + 10);
        bench.steps(healthy - already - 5);
        interrupted(&mut bench);
        assert_eq!(bench.ecu.mode(), expected, "{healthy}");
    }
}

#[test]
fn a_lock_is_released_when_nothing_is_wrong_and_nothing_asked_for() {
    let mut bench = Bench::at(5.0);
    assert_eq!(bench.ecu.release(), Err(ReleaseRefused::NotLocked));
    for _ in 0..4 {
        interrupted(&mut bench);
    }
    bench.steps(1000);
    assert_eq!(bench.ecu.mode(), Mode::Locked);
    assert_eq!(bench.ecu.release(), Err(ReleaseRefused::ReferenceNotAtZero));
    bench.reference_bar = 0.0;
    bench.steps(9);
    assert_eq!(bench.ecu.release(), Err(ReleaseRefused::ReferenceNotAtZero));
    bench.step();
    let released = |bench: &Bench| bench.ecu.clone().release();
    assert_eq!(released(&bench), Ok(()));
    bench.steps_with(3, LATE);
    assert_eq!(released(&bench), Err(ReleaseRefused::FaultPresent));
    bench.steps(2 + 9);
    assert_eq!(released(&bench), Err(ReleaseRefused::FaultPresent));
    bench.step();
    assert_eq!(bench.ecu.release(), Ok(()));
    assert_eq!(bench.ecu.mode(), Mode::Waiting);
    assert!(
        bench.has(Fault::SampleTime),
        "it is reported until running begins"
    );
    bench.steps(9);
    assert_eq!(
        bench.ecu.mode(),
        Mode::Waiting,
        "the reference is seen at zero anew"
    );
    bench.step();
    assert_eq!(bench.ecu.mode(), Mode::Running);
    // All retries are available again.
    bench.reference_bar = 5.0;
    bench.steps(200);
    for _ in 0..3 {
        interrupted(&mut bench);
        assert_eq!(bench.ecu.mode(), Mode::Running);
    }
}

#[test]
fn a_refusal_says_what_to_do() {
    for (refused, part) in [
        (ReleaseRefused::NotLocked, "not locked"),
        (ReleaseRefused::MemoryDamaged, "reset the ECU"),
        (ReleaseRefused::FaultPresent, "mend it first"),
        (ReleaseRefused::ReferenceNotAtZero, "take it back first"),
    ] {
        assert!(refused.to_string().contains(part), "{refused}");
    }
}
