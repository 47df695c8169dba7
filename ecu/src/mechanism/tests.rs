//! Comparison of each mechanism with an ECU without it: the removal has a visible effect.

use super::{Damage, Mechanism};
use crate::bench::Bench;
use crate::{
    Ecu, EcuConfig, EcuSettings, Fault, FaultSet, Inputs, Mode, ReleaseRefused, ResetCause,
    VentValve,
};

const NO_PRESSURE: fn(&mut Inputs) = |inputs| inputs.pressure = None;
const NO_REFERENCE: fn(&mut Inputs) = |inputs| inputs.reference = None;
const LATE: fn(&mut Inputs) = |inputs| inputs.elapsed_us = 30_000;
const FILL_SHORT: fn(&mut Inputs) = |inputs| inputs.current_fill_ma = Some(900);

fn whole() -> EcuConfig {
    EcuConfig::new(&EcuSettings::bench()).unwrap()
}

/// Returns the result of the same scenario for an ECU with the mechanism and for one without it.
fn with_and_without<T>(mechanism: Mechanism, story: impl Fn(Bench) -> T) -> [T; 2] {
    [whole(), whole().without(mechanism)].map(|config| {
        let ecu = Ecu::new(config, ResetCause::PowerOn);
        story(Bench::of(ecu, VentValve::NormallyClosed))
    })
}

fn interrupted(bench: &mut Bench) {
    bench.steps_with(6, NO_PRESSURE);
    bench.steps(20);
}

#[test]
fn without_debounce_a_single_sample_is_a_fault() {
    let modes = with_and_without(Mechanism::Debounce, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.step_with(NO_PRESSURE);
        bench.ecu.mode()
    });
    assert_eq!(modes, [Mode::Running, Mode::Holding]);
}

#[test]
fn without_shutting_on_doubt_a_valve_stays_open_on_no_pressure() {
    let are_off = with_and_without(Mechanism::ShutOnDoubt, |bench| {
        let mut bench = bench.settled_at(1.0);
        bench.reference_bar = 8.0;
        bench.steps(3);
        bench.step_with(NO_PRESSURE);
        bench.is_off()
    });
    assert_eq!(are_off, [true, false]);
}

#[test]
fn without_its_mechanism_a_missing_reference_opens_the_fill_valve_further() {
    let grew = with_and_without(Mechanism::NoIncreaseWithoutReference, |bench| {
        let mut bench = bench.settled_at(3.0);
        bench.reference_bar = 3.3;
        // No air passes the valve, so the boost grows.
        bench.rig.fill_stuck_at = Some(0.0);
        bench.steps(6);
        let before = bench.duties()[0];
        bench.steps_with(4, NO_REFERENCE);
        bench.duties()[0] > before
    });
    assert_eq!(grew, [false, true]);
}

#[test]
fn without_the_neutral_interlock_a_reset_fills_at_once() {
    let filled = with_and_without(Mechanism::NeutralInterlock, |mut bench| {
        bench.reference_bar = 3.0;
        bench.steps(100);
        bench.rig.pressure_bar > 1.0
    });
    assert_eq!(filled, [false, true]);
}

#[test]
fn without_its_limit_holding_never_ends() {
    let modes = with_and_without(Mechanism::HoldLimit, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.steps_with(200, NO_PRESSURE);
        bench.ecu.mode()
    });
    assert_eq!(modes, [Mode::Venting, Mode::Holding]);
}

#[test]
fn without_active_venting_the_pressure_stays_in_the_chamber() {
    let emptied = with_and_without(Mechanism::ActiveVent, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.steps_with(900, LATE);
        assert_eq!(bench.ecu.mode(), Mode::Safe);
        bench.rig.pressure_bar < 0.1
    });
    assert_eq!(emptied, [true, false]);
}

#[test]
fn without_its_limit_venting_never_ends() {
    let modes = with_and_without(Mechanism::VentLimit, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.steps_with(2000, FILL_SHORT);
        bench.ecu.mode()
    });
    assert_eq!(modes, [Mode::Safe, Mode::Venting]);
}

#[test]
fn without_the_ramp_the_pressure_is_lost_at_once() {
    let kept = with_and_without(Mechanism::Ramp, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.steps_with(25, NO_REFERENCE);
        bench.rig.pressure_bar > 3.5
    });
    assert_eq!(kept, [true, false]);
}

#[test]
fn without_the_recovery_ramp_the_pressure_jumps_back() {
    let jumped = with_and_without(Mechanism::RecoveryRamp, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.steps_with(6, NO_PRESSURE);
        bench.rig.pressure_bar = 2.0;
        bench.steps(40);
        assert_eq!(bench.ecu.mode(), Mode::Running);
        bench.rig.pressure_bar > 4.0
    });
    assert_eq!(jumped, [false, true]);
}

#[test]
fn without_bumpless_takeover_the_first_sample_sees_a_change_that_was_none() {
    let signals = with_and_without(Mechanism::BumplessTakeover, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.steps_with(6, NO_PRESSURE);
        bench.reference_bar = 4.0;
        let mut bench_mode = bench.ecu.mode();
        while bench_mode != Mode::Running {
            bench.step();
            bench_mode = bench.ecu.mode();
        }
        bench.ecu.telemetry().control_signal
    });
    // 35 %/bar times an error of 1 bar; 100 % is 409 600.
    let [by_the_error, other] = signals.map(|signal| (signal + 143_360).abs());
    assert!(by_the_error < 8192 && other > 40_960, "{signals:?}");
}

#[test]
fn without_a_limit_of_retries_a_fault_may_come_back_for_ever() {
    let modes = with_and_without(Mechanism::RetryLimit, |bench| {
        let mut bench = bench.settled_at(5.0);
        for _ in 0..6 {
            interrupted(&mut bench);
        }
        bench.steps(1000);
        bench.ecu.mode()
    });
    assert_eq!(modes, [Mode::Locked, Mode::Running]);
}

#[test]
fn without_the_latch_a_fault_is_forgotten_before_somebody_could_see_it() {
    let faults = with_and_without(Mechanism::Latch, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.steps_with(5, NO_PRESSURE);
        bench.steps(6);
        assert_eq!(bench.ecu.mode(), Mode::Holding);
        bench.ecu.faults()
    });
    assert_eq!(faults, [FaultSet::of(Fault::SensorMissing), FaultSet::NONE]);
}

#[test]
fn without_the_interlock_a_damaged_controller_drives_both_valves() {
    let found = with_and_without(Mechanism::BothValvesInterlock, |bench| {
        let mut bench = bench.settled_at(5.0);
        bench.ecu.damage(Damage::Controller);
        bench.step();
        (bench.ecu.mode(), bench.duties())
    });
    assert_eq!(found[0], (Mode::Locked, [0.0, 0.0]));
    assert_eq!(found[1], (Mode::Running, [100.0, 100.0]));
}

#[test]
fn one_removed_mechanism_leaves_the_others() {
    for removed in Mechanism::ALL {
        let config = whole().without(removed).without(removed);
        for mechanism in Mechanism::ALL {
            assert!(whole().has(mechanism));
            assert_eq!(config.has(mechanism), mechanism != removed);
        }
    }
}

#[test]
fn one_removed_detector_leaves_the_others() {
    let all = FaultSet::from_bits(u32::MAX);
    for removed in Fault::ALL {
        let config = whole().without_detector(removed);
        let seen = config.limits.mechanisms.seen(all);
        assert_eq!(seen, all.difference(FaultSet::of(removed)));
    }
}

#[test]
fn damaged_configuration_or_state_locks_in_the_sample_that_sees_it() {
    for damage in [Damage::Config, Damage::Supervisor] {
        for config in [whole(), whole().without_detector(Fault::MemoryDamaged)] {
            let mut bench = Bench::of(
                Ecu::new(config, ResetCause::PowerOn),
                VentValve::NormallyClosed,
            );
            bench.reference_bar = 3.0;
            bench.steps(30);
            bench.ecu.damage(damage);
            bench.step();
            let is_found = config == whole();
            assert_eq!(bench.has(Fault::MemoryDamaged), is_found, "{damage:?}");
            assert_eq!(bench.ecu.mode() == Mode::Locked, is_found, "{damage:?}");
            assert_eq!(bench.is_off(), is_found, "{damage:?}");
            if is_found {
                bench.reference_bar = 0.0;
                bench.steps(50);
                assert_eq!(bench.ecu.release(), Err(ReleaseRefused::MemoryDamaged));
            }
        }
    }
}
