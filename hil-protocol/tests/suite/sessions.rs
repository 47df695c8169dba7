//! Sessions: each kind of misplaced frame, one at a time.

use hil_protocol::frame::{Direction, Header, encode};
use hil_protocol::{
    DeviceSession, Event, FRAME_MAX, HostError, HostSession, LinkCounters, Refusal, Reply, Request,
    VERSION,
};

use crate::messages::sensors;
use crate::stepper::Stepper;

const TRIES: u32 = 3;

struct Pair {
    device: Stepper,
    device_session: DeviceSession,
    host: HostSession,
}

impl Pair {
    fn new() -> Self {
        Self {
            device: Stepper::new(),
            device_session: DeviceSession::new(100),
            host: HostSession::new(TRIES),
        }
    }

    fn open() -> Self {
        let mut pair = Self::new();
        let hello = pair.host.open(7, true).unwrap().to_vec();
        let identity = pair.at_device(&hello).unwrap();
        assert!(matches!(
            pair.at_host(&identity),
            Ok(Some(Event::Opened(_)))
        ));
        pair
    }

    fn at_device(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        self.device_session
            .receive_frame(frame, &mut self.device)
            .map(<[u8]>::to_vec)
    }

    fn at_host(&mut self, frame: &[u8]) -> Result<Option<Event>, HostError> {
        self.host.receive_frame(frame)
    }

    fn request(&mut self, request: &Request) -> Vec<u8> {
        self.host.request(request).unwrap().to_vec()
    }

    fn sample(&mut self, sample: u32) -> Vec<u8> {
        self.request(&Request::Sample(sensors(sample)))
    }

    fn exchange(&mut self, request: &Request) -> Reply {
        let frame = self.request(request);
        let answer = self.at_device(&frame).unwrap();
        match self.at_host(&answer) {
            Ok(Some(Event::Reply(reply))) => reply,
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_session_opens_with_the_device_s_half_of_its_number() {
    let mut pair = Pair::new();
    assert!(!pair.host.is_open());
    let hello = pair.host.open(7, true).unwrap().to_vec();
    let frame = pair.at_device(&hello).unwrap();
    let Ok(Some(Event::Opened(identity))) = pair.at_host(&frame) else {
        panic!("no identity");
    };
    assert_eq!((identity.version, identity.boot), (VERSION, 100));
    assert!(pair.host.is_open() && pair.device_session.lock_step());
}

#[test]
fn a_request_that_comes_twice_is_carried_out_once_and_answered_alike() {
    let mut pair = Pair::open();
    let frame = pair.sample(0);
    let first = pair.at_device(&frame).unwrap();
    let second = pair.at_device(&frame).unwrap();
    assert_eq!((first, pair.device.steps), (second.clone(), 1));
    assert_eq!(pair.device_session.counters().duplicate, 1);
    // The host accepts one of the answers.
    assert!(matches!(pair.at_host(&second), Ok(Some(Event::Reply(_)))));
    assert_eq!(pair.at_host(&second), Ok(None));
    assert_eq!(pair.host.counters().duplicate, 1);
}

#[test]
fn a_request_that_comes_late_is_dropped() {
    let mut pair = Pair::open();
    let old = pair.sample(0);
    let answer = pair.at_device(&old).unwrap();
    pair.at_host(&answer).unwrap();
    pair.exchange(&Request::Sample(sensors(1)));
    assert_eq!(pair.at_device(&old), None);
    assert_eq!(
        (pair.device.steps, pair.device_session.counters().stale),
        (2, 1)
    );
    // The same applies to an answer.
    let waiting = pair.sample(2);
    assert_eq!(pair.at_host(&answer), Ok(None));
    assert_eq!(pair.host.counters().stale, 1);
    let answer = pair.at_device(&waiting).unwrap();
    assert!(matches!(pair.at_host(&answer), Ok(Some(Event::Reply(_)))));
}

#[test]
fn a_hello_that_comes_late_opens_nothing() {
    let mut pair = Pair::new();
    let hello = pair.host.open(7, true).unwrap().to_vec();
    let identity = pair.at_device(&hello).unwrap();
    assert_eq!(
        pair.at_device(&hello),
        Some(identity.clone()),
        "its answer may be lost"
    );
    pair.at_host(&identity).unwrap();
    pair.exchange(&Request::Discard);
    assert_eq!(pair.at_device(&hello), None);
    assert_eq!(pair.device.opened, 1);
    let counters = pair.device_session.counters();
    assert_eq!((counters.duplicate, counters.stale), (1, 1));
}

#[test]
fn a_missing_request_is_named() {
    let mut pair = Pair::open();
    let mut buffer = [0; FRAME_MAX];
    let header = Header {
        direction: Direction::ToDevice,
        session: 107,
        sequence: 3,
    };
    let beyond = encode(header, &Request::Sample(sensors(0)), &mut buffer).unwrap();
    let refusal = Refusal::Skipped {
        expected: 1,
        found: 3,
    };
    let answer = pair.at_device(beyond).unwrap();
    assert_eq!(pair.device.steps, 0);
    assert_eq!(pair.device_session.counters().skipped, 1);
    // The refusal would end the session of a host that waits for this request; this host has not sent it yet.
    assert_eq!(pair.at_host(&answer), Ok(None));
    for _ in 0..2 {
        pair.exchange(&Request::Discard);
    }
    pair.sample(0);
    assert_eq!(
        pair.at_host(&answer),
        Err(HostError::Ended {
            sequence: 3,
            refusal
        })
    );
}

#[test]
fn a_device_that_was_reset_takes_no_part_in_the_session_before() {
    let mut pair = Pair::open();
    pair.exchange(&Request::Sample(sensors(0)));
    pair.device_session = DeviceSession::new(101);
    pair.device = Stepper::new();
    let frame = pair.sample(1);
    let answer = pair.at_device(&frame).unwrap();
    assert_eq!(pair.device.steps, 0);
    assert_eq!(
        pair.at_host(&answer),
        Err(HostError::Ended {
            sequence: 2,
            refusal: Refusal::NoSession
        })
    );
    assert!(!pair.host.is_open());
    assert_eq!(pair.host.request(&Request::Discard), Err(HostError::Closed));
}

/// A late copy of the Hello opens a session after the reset, but not the session of the host.
#[test]
fn a_reset_is_seen_although_the_hello_comes_again() {
    let mut pair = Pair::new();
    let hello = pair.host.open(7, true).unwrap().to_vec();
    let identity = pair.at_device(&hello).unwrap();
    pair.at_host(&identity).unwrap();
    pair.device_session = DeviceSession::new(101);
    pair.at_device(&hello).unwrap();
    let frame = pair.sample(0);
    let answer = pair.at_device(&frame).unwrap();
    assert_eq!(pair.device.steps, 0);
    assert!(matches!(
        pair.at_host(&answer),
        Err(HostError::Ended { .. })
    ));
}

#[test]
fn a_host_that_starts_again_in_mid_frame_gets_a_session() {
    let mut pair = Pair::open();
    let frame = pair.sample(0);
    for &byte in &frame[..frame.len() / 2] {
        pair.device_session.receive_byte(byte, &mut pair.device);
    }
    pair.host = HostSession::new(TRIES);
    let hello = pair.host.open(8, false).unwrap().to_vec();
    assert_eq!(pair.at_device(&hello), None, "the torn frame took it along");
    assert_eq!(pair.device_session.counters().corrupt, 1);
    let again = pair.host.again().unwrap().to_vec();
    let identity = pair.at_device(&again).unwrap();
    assert!(matches!(
        pair.at_host(&identity),
        Ok(Some(Event::Opened(_)))
    ));
    assert!(!pair.device_session.lock_step());
    // Frames of the old session are refused, and the host ignores the refusal.
    let refusal = pair.at_device(&frame).unwrap();
    assert_eq!(pair.at_host(&refusal), Ok(None));
    assert_eq!(pair.device_session.counters().foreign, 1);
    assert_eq!(pair.host.counters().foreign, 1);
    assert_eq!(pair.device.steps, 0);
}

/// The refusal is no answer of the session: after it the last answer can still be repeated.
#[test]
fn a_stranger_costs_the_session_nothing() {
    let mut pair = Pair::open();
    let frame = pair.sample(0);
    let answer = pair.at_device(&frame).unwrap();
    let mut stranger = HostSession::new(TRIES);
    let mut other = DeviceSession::new(5);
    let hello = stranger.open(1, true).unwrap().to_vec();
    let identity = other
        .receive_frame(&hello, &mut Stepper::new())
        .unwrap()
        .to_vec();
    stranger.receive_frame(&identity).unwrap();
    let strange = stranger.request(&Request::Discard).unwrap().to_vec();
    assert!(pair.at_device(&strange).is_some());
    assert_eq!(pair.at_device(&frame), Some(answer));
    assert_eq!(pair.device.steps, 1);
}

#[test]
fn silence_ends_after_the_last_try() {
    let mut pair = Pair::open();
    let frame = pair.sample(0);
    for _ in 1..TRIES {
        assert_eq!(pair.host.again(), Ok(frame.as_slice()));
    }
    assert_eq!(
        pair.host.again(),
        Err(HostError::Unanswered {
            sequence: 1,
            tries: TRIES
        })
    );
    assert_eq!(pair.host.counters().repeated, TRIES - 1);
    assert_eq!(pair.host.again(), Err(HostError::Idle));
}

#[test]
fn one_request_at_a_time() {
    let mut pair = Pair::open();
    pair.sample(0);
    assert_eq!(
        pair.host.request(&Request::Discard),
        Err(HostError::Waiting { sequence: 1 })
    );
}

#[test]
fn an_echo_is_no_answer() {
    let mut pair = Pair::open();
    let frame = pair.sample(0);
    assert_eq!(pair.at_host(&frame), Ok(None));
    assert_eq!(pair.host.counters().echoed, 1);
    let answer = pair.at_device(&frame).unwrap();
    assert_eq!(pair.at_device(&answer), None);
    assert_eq!(pair.device_session.counters().echoed, 1);
    assert!(matches!(pair.at_host(&answer), Ok(Some(Event::Reply(_)))));
}

#[test]
fn another_version_is_refused_by_name() {
    let mut pair = Pair::new();
    pair.host.open(7, true).unwrap();
    let header = Header {
        direction: Direction::ToDevice,
        session: 7,
        sequence: 0,
    };
    let hello = Request::Hello {
        version: VERSION + 1,
        lock_step: true,
    };
    let mut buffer = [0; FRAME_MAX];
    let frame = encode(header, &hello, &mut buffer).unwrap();
    let answer = pair.at_device(frame).unwrap();
    assert_eq!(pair.device.opened, 0);
    let error = pair.at_host(&answer).unwrap_err();
    assert_eq!(
        error,
        HostError::Ended {
            sequence: 0,
            refusal: Refusal::Version { device: VERSION }
        }
    );
    assert!(error.to_string().contains("version 1"), "{error}");
}

/// A message of a later version in an undamaged frame is answered: silence would look like a broken wire.
#[test]
fn an_unknown_message_is_answered() {
    let mut pair = Pair::open();
    let header = Header {
        direction: Direction::ToDevice,
        session: 107,
        sequence: 1,
    };
    let mut buffer = [0; FRAME_MAX];
    let frame = encode(header, &200_u8, &mut buffer).unwrap();
    pair.request(&Request::Discard);
    let answer = pair.at_device(frame).unwrap();
    assert_eq!(
        pair.at_host(&answer),
        Ok(Some(Event::Reply(Reply::Refused(Refusal::UnknownMessage))))
    );
    assert_eq!(pair.device_session.counters().unknown, 1);
    assert_eq!(pair.exchange(&Request::Discard), Reply::Done);
}

#[test]
fn samples_come_from_the_link_in_lock_step_only() {
    let mut pair = Pair::new();
    let hello = pair.host.open(7, false).unwrap().to_vec();
    let identity = pair.at_device(&hello).unwrap();
    pair.at_host(&identity).unwrap();
    assert_eq!(
        pair.exchange(&Request::Sample(sensors(0))),
        Reply::Refused(Refusal::NotInLockStep)
    );
    assert_eq!(pair.device.steps, 0);
}

#[test]
fn what_nobody_asked_for_disturbs_no_request() {
    let mut pair = Pair::open();
    let measured = Reply::Measured {
        sample: 5,
        values: Default::default(),
    };
    let frame = pair.sample(0);
    let mut buffer = [0; FRAME_MAX];
    let unsolicited = pair
        .device_session
        .unsolicited(&measured, &mut buffer)
        .unwrap()
        .to_vec();
    assert_eq!(
        pair.at_host(&unsolicited),
        Ok(Some(Event::Unsolicited(measured)))
    );
    let answer = pair.at_device(&frame).unwrap();
    assert!(matches!(pair.at_host(&answer), Ok(Some(Event::Reply(_)))));
}

#[test]
fn nothing_is_sent_unasked_before_a_session() {
    let session = DeviceSession::new(1);
    let mut buffer = [0; FRAME_MAX];
    assert_eq!(session.unsolicited(&Reply::Done, &mut buffer), None);
}

#[test]
fn the_device_s_counters_are_read_over_the_link() {
    let mut pair = Pair::open();
    pair.exchange(&Request::Discard);
    let expected = LinkCounters {
        accepted: 3,
        ..LinkCounters::ZERO
    };
    assert_eq!(pair.exchange(&Request::Counters), Reply::Counters(expected));
}
