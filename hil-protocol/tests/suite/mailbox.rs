//! Mailbox: frames through shared memory.

use std::sync::atomic::AtomicU32;
use std::thread;

use hil_protocol::mailbox::{Mailbox, MailboxError, WORDS};
use hil_protocol::{DeviceSession, Event, FRAME_MAX, HostSession, Reply, Request};

use crate::messages::sensors;
use crate::stepper::Stepper;

fn memory(filled_with: u32) -> [AtomicU32; WORDS] {
    std::array::from_fn(|_| AtomicU32::new(filled_with))
}

#[test]
fn a_frame_of_every_length_arrives_whole_once() {
    let memory = memory(0);
    let (host, device) = (Mailbox::host(&memory), Mailbox::device(&memory));
    let mut buffer = [0; FRAME_MAX];
    for length in 0..=FRAME_MAX {
        let frame: Vec<u8> = (0..length)
            .map(|index| (index * 7 + length) as u8)
            .collect();
        host.send(&frame).unwrap();
        assert_eq!(host.send(&frame), Err(MailboxError::Full));
        assert_eq!(device.receive(&mut buffer), Some(frame.as_slice()));
        assert_eq!(device.receive(&mut buffer), None);
        assert_eq!(
            host.receive(&mut buffer),
            None,
            "the other way is another slot"
        );
    }
    let too_long = [0; FRAME_MAX + 1];
    assert_eq!(
        host.send(&too_long),
        Err(MailboxError::TooLong {
            length: FRAME_MAX + 1
        })
    );
    assert_eq!(device.receive(&mut buffer), None);
}

/// After power-on the memory has any content; a side drops it at its start.
#[test]
fn whatever_memory_holds_is_no_frame() {
    for word in [0, 1, 0xFFFF_FFFF, 0xCCCC_CCCC] {
        let memory = memory(word);
        let mut buffer = [0; FRAME_MAX];
        // Half a count was written.
        memory[0].store(word.wrapping_add(3), std::sync::atomic::Ordering::Relaxed);
        let device = Mailbox::device(&memory);
        assert_eq!(device.receive(&mut buffer), None);
        let host = Mailbox::host(&memory);
        host.send(b"first").unwrap();
        assert_eq!(device.receive(&mut buffer), Some(b"first".as_slice()));
    }
}

#[test]
fn an_impossible_length_is_an_empty_frame() {
    let memory = memory(0);
    let (host, device) = (Mailbox::host(&memory), Mailbox::device(&memory));
    host.send(b"frame").unwrap();
    memory[2].store(FRAME_MAX as u32 + 1, std::sync::atomic::Ordering::Relaxed);
    let mut buffer = [0; FRAME_MAX];
    assert_eq!(device.receive(&mut buffer), Some([].as_slice()));
    host.send(b"next").unwrap();
    assert_eq!(device.receive(&mut buffer), Some(b"next".as_slice()));
}

/// Two threads with independent speeds: every received frame is complete and in order.
#[test]
fn two_sides_at_once_exchange_samples_bit_for_bit() {
    const SAMPLES: u32 = 10_000;
    let memory = memory(0);
    let host_mailbox = Mailbox::host(&memory);
    let device_mailbox = Mailbox::device(&memory);
    thread::scope(|scope| {
        scope.spawn(move || {
            let mut session = DeviceSession::new(1);
            let mut device = Stepper::new();
            let mut buffer = [0; FRAME_MAX];
            while device.steps < SAMPLES {
                match device_mailbox.receive(&mut buffer) {
                    Some(frame) => {
                        let answer = session.receive_frame(frame, &mut device).unwrap();
                        device_mailbox.send(answer).unwrap();
                    }
                    None => thread::yield_now(),
                }
            }
            assert_eq!(session.counters().accepted, SAMPLES + 1);
        });
        let mut session = HostSession::new(1);
        let mut twin = Stepper::new();
        let mut buffer = [0; FRAME_MAX];
        let mut receive = |session: &mut HostSession| loop {
            match host_mailbox.receive(&mut buffer) {
                Some(frame) => break session.receive_frame(frame).unwrap().unwrap(),
                None => thread::yield_now(),
            }
        };
        host_mailbox.send(session.open(3, true).unwrap()).unwrap();
        assert!(matches!(receive(&mut session), Event::Opened(_)));
        for sample in 0..SAMPLES {
            let request = Request::Sample(sensors(sample));
            host_mailbox
                .send(session.request(&request).unwrap())
                .unwrap();
            let Event::Reply(Reply::Sample { answer, .. }) = receive(&mut session) else {
                panic!("no answer to sample {sample}");
            };
            assert_eq!(answer, twin.step(&sensors(sample)));
        }
    });
}
