//! Source of the pace, and the duty cycles of the coils at its changes.

use ecu::calibration::SignalId;
use ecu::{Outputs, safe_outputs};
use firmware::{Event, Pace};
use hil_protocol::{Refusal, Reply, Request, Sensors};

use crate::bench::{Deed, Machine, Memory, PERIOD_US, sensors};

const FED: Deed = Deed::Feed(Pace::Timer);

#[test]
fn each_tick_is_one_sample_and_the_watchdog_is_fed_after_its_coils_are_driven() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.board().deeds.clear();
    machine.ticks(3);
    let sample = [Deed::Measure, Deed::Drive(safe_outputs()), FED];
    assert_eq!(machine.board().deeds, sample.repeat(3));
}

#[test]
fn without_a_tick_nothing_is_measured_nothing_is_driven_and_the_watchdog_bites() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    machine.board().deeds.clear();
    for _ in 0..10_000 {
        machine.ask(&Request::Counters);
    }
    let deeds = &machine.board().deeds;
    assert!(deeds.iter().all(|deed| *deed == Deed::Send), "{deeds:?}");
}

#[test]
fn a_missed_tick_is_logged_with_its_sample() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.ticks(5);
    machine.board().tick();
    machine.board().tick();
    machine.tick();
    let missed = Event::TicksMissed {
        sample: 5,
        missed: 2,
    };
    assert!(machine.board().events.contains(&missed));
    assert_eq!(machine.board().count(Deed::Measure), 6);
}

/// The longest request takes less than a millisecond: none is in progress at the next tick.
#[test]
fn a_request_in_the_last_millisecond_before_a_tick_is_answered_after_its_sample() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    machine.ticks(1);
    for (since_tick_us, answered) in [(8_999, true), (9_000, false), (9_999, false)] {
        machine.board().wait_us(since_tick_us);
        machine.board().deeds.clear();
        machine.say(&Request::Counters);
        let _ = machine.image.turn();
        assert_eq!(machine.board().count(Deed::Send) == 1, answered);
        machine.board().deeds.clear();
        machine.tick();
        let sample = [Deed::Measure, Deed::Drive(safe_outputs()), FED];
        assert_eq!(machine.board().deeds[..3], sample);
        assert_eq!(machine.board().count(Deed::Send) == 1, !answered);
    }
}

#[test]
fn samples_come_by_request_only_where_the_host_sets_the_pace() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    let sample = Request::Sample(sensors(0));
    let refused = Reply::Refused(Refusal::NotInLockStep);
    machine.hello(false);
    assert_eq!(machine.ask(&sample), refused);

    machine.hello(true);
    machine.samples(0, 5);
    machine.board().deeds.clear();
    machine.ticks(5);
    assert_eq!(machine.board().count(Deed::Measure), 0);

    machine.hello(false);
    assert_eq!(machine.ask(&sample), refused);
    machine.ticks(5);
    assert_eq!(machine.board().count(Deed::Measure), 5);
}

/// Simulated pressures must never drive the valves of a truck.
#[test]
fn a_board_without_its_jumper_takes_no_simulated_sample() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.board().jumper = false;
    machine.hello(true);
    assert_eq!(
        machine.ask(&Request::Sample(sensors(0))),
        Reply::Refused(Refusal::NotInLockStep)
    );
    machine.ticks(1);
    assert_eq!(machine.board().count(Deed::Measure), 1);
}

/// Returns the sensors of a rig at rest, with a reference of 3 bar.
fn asking(sample: u32) -> Sensors {
    Sensors {
        reference: Some(3 << 16),
        ..sensors(sample)
    }
}

/// Runs until the reference was zero, then asks for 3 bar: the fill valve works.
fn filling(machine: &mut Machine<'_>) -> Outputs {
    machine.ticks(12);
    machine.board().inputs.reference = Some(controller::Pressure::from_bits(3 << 16));
    machine.ticks(2);
    let outputs = machine.board().outputs;
    assert_ne!(outputs, safe_outputs());
    outputs
}

#[test]
fn a_host_that_only_looks_on_does_not_disturb_a_running_loop() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    let outputs = filling(&mut machine);
    machine.board().deeds.clear();
    machine.hello(false);
    assert_eq!(machine.board().deeds, [Deed::Send]);
    machine.tick();
    assert_ne!(machine.board().outputs, safe_outputs());
    assert_eq!(outputs.duty_vent, machine.board().outputs.duty_vent);
}

/// Values from before the change are not used after it: the reference has to be zero again.
#[test]
fn a_change_of_pace_switches_the_coils_off_and_starts_the_logic_again() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    filling(&mut machine);
    machine.hello(true);
    assert_eq!(machine.board().outputs, safe_outputs());
    machine.ask(&Request::Sample(asking(0)));
    assert_eq!(machine.board().outputs.duty_fill, controller::Duty::OFF);
}

#[test]
fn with_the_pace_the_sensors_come_back() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(true);
    let simulated = Sensors {
        battery_mv: Some(31_000),
        ..sensors(0)
    };
    machine.ask(&Request::Sample(simulated));
    machine.hello(false);
    machine.measure(&[SignalId::Battery as u16]);
    machine.ticks(1);
    assert_eq!(first_value(&machine.unsolicited[0]), 24_000);
}

#[test]
fn a_host_that_sets_the_pace_and_goes_silent_leaves_the_coils_off() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(true);
    machine.samples(0, 12);
    machine.ask(&Request::Sample(asking(12)));
    assert_ne!(machine.board().outputs, safe_outputs());
    machine.board().deeds.clear();
    machine.board().clock_us += 1_000_001;
    for _ in 0..5000 {
        let _ = machine.image.turn();
    }
    assert_eq!(machine.board().outputs, safe_outputs());
    assert_eq!(machine.board().count(Deed::CoilsOff), 1);
    assert!(machine.board().count(Deed::Feed(Pace::Host)) > 0);
}

#[test]
fn the_time_between_two_samples_is_the_clocks_and_not_the_nominal_one() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    machine.measure(&[SignalId::Elapsed as u16]);
    machine.ticks(1);
    machine.board().tick();
    machine.board().wait_us(250);
    let _ = machine.image.turn();
    machine.ticks(1);
    let elapsed: Vec<i32> = machine.unsolicited.iter().map(first_value).collect();
    let period = PERIOD_US as i32;
    assert_eq!(elapsed, [period, period + 250, period - 250]);
}

fn first_value(reply: &Reply) -> i32 {
    match reply {
        Reply::Measured { values, .. } => values[0],
        other => panic!("{other:?}"),
    }
}
