//! Access of a calibration tool while the image runs.

use ecu::calibration::{MISSING, SignalId};
use firmware::{Event, FIRST_SIGNAL, SIGNALS};
use hil_protocol::{Refusal, Reply, Request, ResetCause};

use crate::bench::Memory;

const LAST: u16 = FIRST_SIGNAL + SIGNALS.len() as u16 - 1;

fn id(name: &str) -> u16 {
    let row = SIGNALS.iter().position(|signal| signal.name == name);
    FIRST_SIGNAL + u16::try_from(row.unwrap()).unwrap()
}

#[test]
fn signals_of_ecu_and_image_come_with_each_sample_in_the_order_they_were_asked_for() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    let ids = [
        id("start_latency"),
        SignalId::Sample as u16,
        id("ticks_missed"),
        SignalId::PressureCode as u16,
    ];
    assert_eq!(machine.measure(&ids), Reply::Done);
    for since_tick_us in [3, 40] {
        machine.board().tick();
        machine.board().wait_us(since_tick_us);
        let _ = machine.image.turn();
    }
    machine.ask(&Request::Counters);
    let found = machine.unsolicited.iter().map(|reply| match reply {
        Reply::Measured { sample, values } => (*sample, values.to_vec()),
        other => panic!("{other:?}"),
    });
    let found: Vec<_> = found.collect();
    assert_eq!(found, [(0, vec![3, 0, 0, 127]), (1, vec![40, 1, 0, 127])]);
}

#[test]
fn signals_of_the_image_alone_come_with_each_sample_too() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    assert_eq!(machine.measure(&[id("ticks_missed")]), Reply::Done);
    machine.ticks(2);
    assert_eq!(machine.unsolicited.len(), 2);
    assert_eq!(machine.measure(&[]), Reply::Done);
    machine.ticks(2);
    assert_eq!(machine.unsolicited.len(), 2);
}

#[test]
fn a_host_does_not_get_what_the_one_before_it_asked_for() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    machine.measure(&[id("ticks_missed"), SignalId::Mode as u16]);
    machine.hello(false);
    machine.ticks(2);
    assert!(machine.unsolicited.is_empty());
}

#[test]
fn a_signal_that_does_not_exist_is_refused_and_changes_nothing() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    assert_eq!(machine.measure(&[id("start_latency")]), Reply::Done);
    let refused = |id, last| Reply::Refused(Refusal::UnknownSignal { id, last });
    let last_of_ecu = ecu::calibration::SIGNAL_COUNT as u16 - 1;
    for (unknown, last) in [
        (LAST + 1, LAST),
        (u16::MAX, LAST),
        (last_of_ecu + 1, last_of_ecu),
    ] {
        assert_eq!(machine.measure(&[unknown]), refused(unknown, last));
        let reply = machine.ask(&Request::Signal { id: unknown });
        assert_eq!(reply, refused(unknown, last));
    }
    machine.ticks(1);
    assert_eq!(machine.unsolicited.len(), 1);
}

#[test]
fn where_a_host_sets_the_pace_no_sample_is_late() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.ticks(5);
    machine.hello(true);
    machine.samples(0, 3);
    for id in FIRST_SIGNAL..=LAST {
        match machine.ask(&Request::Signal { id }) {
            Reply::Values { first, values } => assert_eq!((first, values[0]), (id, MISSING)),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn each_start_of_the_logic_is_logged_with_its_first_mode() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(true);
    machine.samples(0, 3);
    let cause = ResetCause::PowerOn;
    machine.done(&Request::Restart { cause });
    machine.samples(3, 3);
    let events = machine.board().events.iter();
    let logged: Vec<u32> = events
        .filter_map(|event| match event {
            Event::Supervisor { sample, .. } => Some(*sample),
            _ => None,
        })
        .collect();
    assert_eq!(logged, [0, 3]);
}

#[test]
fn the_log_leaves_over_the_link_with_the_count_of_what_was_lost() {
    let mut memory = Memory::cold();
    let mut machine = memory.start();
    machine.hello(false);
    match machine.ask(&Request::Log) {
        Reply::Log { bytes, lost } => assert_eq!((&bytes[..], lost), (&b"log"[..], 7)),
        other => panic!("{other:?}"),
    }
}
