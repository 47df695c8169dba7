//! Detection of each fault that is visible in an input: confirmed and answered in its N-th sample, and not before.

use ecu::{Fault, FaultReaction, Inputs, Mode, SensorCode};

use crate::bench::{Bench, code};

/// Test case: a fault, the bench before it, and the change of the inputs from then on.
struct Case {
    fault: Fault,
    before: fn() -> Bench,
    wrong: fn(&mut Inputs),
}

fn holding() -> Bench {
    Bench::at(3.0)
}

/// Returns a bench that has been filling with a high duty cycle for longer than the settling time of a valve.
fn filling() -> Bench {
    let mut bench = Bench::at(1.0);
    bench.reference_bar = 8.0;
    bench.steps(10);
    assert!(bench.duties()[0] > 50.0, "{:?}", bench.duties());
    bench
}

fn venting() -> Bench {
    let mut bench = Bench::at(7.0);
    bench.reference_bar = 0.5;
    bench.steps(10);
    assert!(bench.duties()[1] > 50.0, "{:?}", bench.duties());
    bench
}

const CASES: [Case; 15] = [
    Case {
        fault: Fault::SensorOpen,
        before: holding,
        wrong: |i| i.pressure = Some(SensorCode::MIN),
    },
    Case {
        fault: Fault::SensorShort,
        before: holding,
        wrong: |i| i.pressure = Some(SensorCode::MAX),
    },
    Case {
        fault: Fault::SensorBelowRange,
        before: holding,
        wrong: |i| i.pressure = SensorCode::from_bits(31),
    },
    Case {
        fault: Fault::SensorAboveRange,
        before: holding,
        wrong: |i| i.pressure = Some(code(10.3)),
    },
    Case {
        fault: Fault::SensorJump,
        before: holding,
        wrong: |i| i.pressure = Some(code(5.0)),
    },
    Case {
        fault: Fault::SensorMissing,
        before: holding,
        wrong: |i| i.pressure = None,
    },
    Case {
        fault: Fault::FillCoilOpen,
        before: filling,
        wrong: |i| i.current_fill_ma = Some(0),
    },
    Case {
        fault: Fault::FillCoilShort,
        before: holding,
        wrong: |i| i.current_fill_ma = Some(900),
    },
    Case {
        fault: Fault::VentCoilOpen,
        before: venting,
        wrong: |i| i.current_vent_ma = Some(0),
    },
    Case {
        fault: Fault::VentCoilShort,
        before: holding,
        wrong: |i| i.current_vent_ma = Some(900),
    },
    Case {
        fault: Fault::BatteryLow,
        before: holding,
        wrong: |i| i.battery_mv = Some(15_000),
    },
    Case {
        fault: Fault::BatteryHigh,
        before: holding,
        wrong: |i| i.battery_mv = Some(36_001),
    },
    Case {
        fault: Fault::SampleTime,
        before: holding,
        wrong: |i| i.elapsed_us = 30_000,
    },
    Case {
        fault: Fault::ReferenceLost,
        before: holding,
        wrong: |i| i.reference = None,
    },
    Case {
        fault: Fault::ReferenceLost,
        before: filling,
        wrong: |i| i.reference = None,
    },
];

const fn mode_of(reaction: FaultReaction) -> Mode {
    match reaction {
        FaultReaction::Hold => Mode::Holding,
        FaultReaction::Ramp => Mode::Ramping,
        FaultReaction::Release | FaultReaction::Vent => Mode::Venting,
        FaultReaction::Off => Mode::Safe,
        FaultReaction::Lock => Mode::Locked,
    }
}

#[test]
fn n_wrong_samples_are_answered_in_the_nth_and_one_less_is_not() {
    for Case {
        fault,
        before,
        wrong,
    } in CASES
    {
        let mut bench = before();
        for sample in 1..=fault.samples() + 1 {
            bench.step_with(wrong);
            let (mode, expected) = (bench.ecu.mode(), mode_of(fault.reaction()));
            assert_eq!(
                bench.has(fault),
                sample >= fault.samples(),
                "{fault:?}, {sample}"
            );
            assert_eq!(
                mode == expected,
                sample >= fault.samples(),
                "{fault:?}, {sample}, {mode:?}"
            );
        }
    }
}

#[test]
fn one_sample_less_than_n_leaves_no_trace() {
    for Case {
        fault,
        before,
        wrong,
    } in CASES
    {
        let mut bench = before();
        bench.steps_with(u32::from(fault.samples()) - 1, wrong);
        bench.steps(300);
        assert_eq!(bench.ecu.mode(), Mode::Running, "{fault:?}");
        assert!(bench.ecu.faults().is_empty(), "{fault:?}");
        let error_bar = bench.rig.pressure_bar - bench.reference_bar;
        assert!(error_bar.abs() < 0.1, "{fault:?}: {error_bar} bar");
    }
}

/// A broken valve is visible only in the pressure, after a command that reveals it.
#[test]
fn a_broken_valve_or_supply_is_found_within_20_samples_of_the_command_that_shows_it() {
    type Case = (
        &'static str,
        fn() -> Bench,
        fn(&mut Bench),
        &'static [Fault],
    );
    let cases: [Case; 6] = [
        (
            "fill valve stuck closed",
            filling,
            |b| b.rig.fill_stuck_at = Some(0.0),
            &[Fault::NoRise],
        ),
        (
            "fill valve stuck open, shut",
            holding,
            |b| b.rig.fill_stuck_at = Some(1.0),
            &[Fault::UncommandedRise],
        ),
        (
            "fill valve stuck open, venting",
            venting,
            |b| b.rig.fill_stuck_at = Some(1.0),
            &[Fault::NoFall],
        ),
        (
            "vent valve stuck closed",
            venting,
            |b| b.rig.vent_stuck_at = Some(0.0),
            &[Fault::NoFall],
        ),
        (
            "vent valve stuck open, filling",
            filling,
            |b| b.rig.vent_stuck_at = Some(1.0),
            &[Fault::NoRise, Fault::SupplyLost],
        ),
        (
            "supply lost",
            filling,
            |b| b.rig.supply_bar = 0.0,
            &[Fault::NoRise, Fault::SupplyLost],
        ),
    ];
    for (name, before, breaks, expected) in cases {
        let mut bench = before();
        breaks(&mut bench);
        let found = (0..20).find_map(|_| {
            bench.step();
            let faults = bench.ecu.faults();
            (!faults.is_empty()).then_some(faults)
        });
        let found = found.unwrap_or_else(|| panic!("{name} is not found"));
        assert!(
            expected.iter().any(|&fault| found.contains(fault)),
            "{name}: {found}"
        );
        assert_ne!(bench.ecu.mode(), Mode::Running, "{name}");
    }
}

/// The duty cycle stays too low for a certainly open valve, and the code does not change.
#[test]
fn a_sensor_that_is_stuck_is_found_when_a_valve_was_driven_for_n_samples() {
    let mut bench = Bench::at(3.0);
    let stuck = bench.inputs().pressure;
    bench.reference_bar = 3.3;
    let mut driven = 0;
    while bench.ecu.mode() == Mode::Running {
        driven += u32::from(!bench.is_off());
        bench.step_with(|inputs| inputs.pressure = stuck);
    }
    assert!(
        driven <= u32::from(Fault::SensorStuck.samples()),
        "{driven}"
    );
    assert!(driven > 2);
    assert_eq!(bench.ecu.mode(), Mode::Venting);
}

/// Ten times the noise of the bench for 100 ms: nothing is latched, and the pressure hardly changes.
#[test]
fn a_burst_of_noise_latches_nothing() {
    for seed in 0..50_u64 {
        let mut bench = Bench::at(3.0);
        let mut chance = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        for _ in 0..10 {
            chance ^= chance << 13;
            chance ^= chance >> 7;
            chance ^= chance << 17;
            // Uniform within two standard deviations of 40 mbar: 16 codes.
            let noise = (chance >> 32) as u16 % 33;
            bench.step_with(|inputs| {
                let bits = inputs.pressure.unwrap().bits() + noise - 16;
                inputs.pressure = SensorCode::from_bits(bits);
            });
        }
        assert!(
            bench.ecu.faults().is_empty(),
            "seed {seed}: {}",
            bench.ecu.faults()
        );
        bench.steps(100);
        assert_eq!(bench.ecu.mode(), Mode::Running);
        let error_bar = bench.rig.pressure_bar - 3.0;
        assert!(error_bar.abs() < 0.2, "seed {seed}: {error_bar} bar");
    }
}

/// The sensor shows half a bar too much and the reference is zero. The fault is found when the vent valve was fully
/// open for two seconds; after retries the ECU locks.
#[test]
fn a_chamber_that_shows_pressure_when_it_was_vented_is_an_offset() {
    let offset = |inputs: &mut Inputs| {
        let bits = inputs.pressure.unwrap().bits() + 100;
        inputs.pressure = SensorCode::from_bits(bits);
    };
    let mut bench = Bench::new();
    let found = (0..1000).find(|_| {
        bench.step_with(offset);
        bench.has(Fault::SensorOffset)
    });
    assert!((200..300).contains(&found.unwrap()), "{found:?}");
    let mut samples = 0;
    while bench.ecu.mode() != Mode::Locked {
        bench.step_with(offset);
        samples += 1;
        assert!(samples < 4 * 700, "{:?}", bench.ecu.mode());
    }
}

/// Documented limit: a sensor that is stuck while nothing is driven looks like a chamber at rest.
#[test]
fn a_sensor_that_is_stuck_at_rest_is_not_found() {
    let mut bench = Bench::at(3.0);
    let stuck = bench.inputs().pressure;
    bench.steps_with(10_000, |inputs| inputs.pressure = stuck);
    assert_eq!(bench.ecu.mode(), Mode::Running);
    assert!(bench.ecu.faults().is_empty());
}

/// Documented limit: the loop compensates the leak, and the pressure equals the reference.
#[test]
fn a_leak_that_the_loop_makes_up_for_is_not_found() {
    let mut bench = Bench::at(3.0);
    bench.rig.vent_stuck_at = Some(0.3);
    bench.steps(1000);
    assert_eq!(bench.ecu.mode(), Mode::Running);
    let error_bar = bench.rig.pressure_bar - 3.0;
    assert!(error_bar.abs() < 0.5, "{error_bar} bar");
}
