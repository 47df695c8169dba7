//! Requirements on both sides of a link for any bytes, used by the fuzz target and by the tests of this crate.

use hil_protocol::{
    DeviceSession, Event, FRAME_MAX, HostSession, LinkCounters, Request, Sensors, crc32,
};

use crate::stepper::Stepper;

/// Interprets any bytes as a script of frames: valid, damaged, forged and missing ones, in any order and in both
/// directions. Nothing panics, every frame is counted at most once, no request is carried out without being accepted,
/// and afterwards a session can be opened.
pub(crate) fn sessions(script: &[u8]) {
    let mut link = Link::new();
    let mut script = Script(script);
    while let Some(step) = script.byte() {
        link.take(step, &mut script);
        link.is_consistent();
    }
    link.recovers();
}

/// Rest of a script.
struct Script<'a>(&'a [u8]);

impl<'a> Script<'a> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    /// Takes as many bytes as the next byte specifies.
    fn bytes(&mut self) -> &'a [u8] {
        let length = usize::from(self.byte().unwrap_or(0)).min(self.0.len());
        let (bytes, rest) = self.0.split_at(length);
        self.0 = rest;
        bytes
    }
}

struct Link {
    device: Stepper,
    device_session: DeviceSession,
    host_session: HostSession,
    /// Last frame of each side.
    to_device: Vec<u8>,
    to_host: Vec<u8>,
    /// Number of frame ends that each side saw.
    device_saw: u32,
    host_saw: u32,
    samples: u32,
}

impl Link {
    fn new() -> Self {
        Self {
            device: Stepper::new(),
            device_session: DeviceSession::new(7),
            host_session: HostSession::new(3),
            to_device: Vec::new(),
            to_host: Vec::new(),
            device_saw: 0,
            host_saw: 0,
            samples: 0,
        }
    }

    fn take(&mut self, step: u8, script: &mut Script<'_>) {
        match step % 8 {
            0 => self.ask(script.byte().unwrap_or(0)),
            1 => self.deliver_to_device(&self.to_device.clone()),
            2 => self.deliver_to_host(&self.to_host.clone()),
            3 => self.deliver_to_device(&damaged(&self.to_device, script)),
            4 => self.deliver_to_host(&damaged(&self.to_host, script)),
            5 => self.deliver_to_device(&forged(script.bytes())),
            6 => self.deliver_to_host(&forged(script.bytes())),
            _ => {
                let bytes = script.bytes();
                self.deliver_to_device(bytes);
                self.deliver_to_host(bytes);
            }
        }
    }

    /// Lets the host open a session, make a request, or repeat one.
    fn ask(&mut self, what: u8) {
        let frame = match what % 4 {
            0 => self.host_session.open(u32::from(what), what & 4 == 0),
            1 => self.host_session.again(),
            2 => self.host_session.request(&Request::Discard),
            _ => {
                self.samples += 1;
                self.host_session.request(&Request::Sample(Sensors {
                    sample: self.samples,
                    elapsed_us: 10_000,
                    reference: None,
                    pressure: Some(what.into()),
                    current_fill_ma: None,
                    current_vent_ma: None,
                    battery_mv: None,
                }))
            }
        };
        if let Ok(frame) = frame {
            is_a_frame(frame);
            self.to_device = frame.to_vec();
        }
    }

    fn deliver_to_device(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.device_saw += u32::from(byte == 0);
            if let Some(frame) = self.device_session.receive_byte(byte, &mut self.device) {
                is_a_frame(frame);
                self.to_host = frame.to_vec();
            }
        }
    }

    fn deliver_to_host(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.host_saw += u32::from(byte == 0);
            // The end of the session is one of the possible results.
            let _ = self.host_session.receive_byte(byte);
        }
    }

    fn is_consistent(&self) {
        let device = self.device_session.counters();
        assert!(frames(&device) <= self.device_saw, "{device:?}");
        assert!(frames(&self.host_session.counters()) <= self.host_saw);
        assert!(self.device.steps + self.device.opened <= device.accepted);
    }

    /// Checks that earlier bytes on the wire damage at most the frame that is not ended yet.
    fn recovers(mut self) {
        self.deliver_to_device(&[0]);
        self.deliver_to_host(&[0]);
        let hello = self.host_session.open(0xDEAD_BEEF, true).unwrap().to_vec();
        self.deliver_to_device(&hello);
        let answer = self.to_host.clone();
        let opened = self.host_session.receive_frame(&answer);
        assert!(matches!(opened, Ok(Some(Event::Opened(_)))), "{opened:?}");
    }
}

/// Returns the number of counted frames.
fn frames(counters: &LinkCounters) -> u32 {
    let LinkCounters {
        accepted,
        corrupt,
        unknown,
        echoed,
        duplicate,
        stale,
        foreign,
        skipped,
        repeated: _,
    } = *counters;
    accepted + corrupt + unknown + echoed + duplicate + stale + foreign + skipped
}

fn is_a_frame(frame: &[u8]) {
    assert!(frame.len() <= FRAME_MAX);
    assert_eq!(
        frame.iter().position(|&byte| byte == 0),
        Some(frame.len() - 1)
    );
}

/// Returns the frame with one changed byte.
fn damaged(frame: &[u8], script: &mut Script<'_>) -> Vec<u8> {
    let mut frame = frame.to_vec();
    let at = usize::from(script.byte().unwrap_or(0));
    let flips = script.byte().unwrap_or(1);
    if let Some(byte) = frame.get_mut(at) {
        *byte ^= flips;
    }
    frame
}

/// Returns a frame with a correct checksum and any content.
fn forged(payload: &[u8]) -> Vec<u8> {
    let mut payload = payload.to_vec();
    payload.extend(crc32::digest(&payload).to_le_bytes());
    let mut frame = cobs::encode_vec(&payload);
    frame.push(0);
    frame
}
