//! Device's side of a session.

use super::{Place, session_number};
use crate::counters::{LinkCounters, count};
use crate::device::Device;
use crate::frame::{self, DELIMITER, Decoder, Direction, FRAME_MAX, Header};
use crate::message::{Refusal, Reply, Request, VERSION};

/// Buffer size for the frame of a [`Refusal`].
const REFUSAL_MAX: usize = 64;

/// Device's side of a link: bytes in, bytes out, no clock.
///
/// ```text
///              Hello                          next request: carried out, answered
///  no session ───────► open, request n due ──┐
///      ▲                 ▲   ▲               │ the last request again: answered alike, not carried out
///      │ reset           │   └───────────────┘ an older one: dropped; a later one: refused
///      └─────────────────┤
///                        └── Hello with another nonce: another session
/// ```
#[derive(Clone, Debug)]
pub struct DeviceSession {
    decoder: Decoder,
    conversation: Conversation,
}

impl DeviceSession {
    /// Creates the side without a session. `boot` differs from boot to boot, for example a counter in RAM that a reset
    /// does not change.
    pub const fn new(boot: u32) -> Self {
        Self {
            decoder: Decoder::new(),
            conversation: Conversation {
                boot,
                session: None,
                counters: LinkCounters::ZERO,
                answer: [0; FRAME_MAX],
                answer_length: 0,
                refusal: [0; REFUSAL_MAX],
            },
        }
    }

    /// Takes one byte from the wire; returns the frame to send, including the delimiter, once a request is complete.
    pub fn receive_byte<D: Device>(&mut self, byte: u8, device: &mut D) -> Option<&[u8]> {
        let Self {
            decoder,
            conversation,
        } = self;
        match decoder.push(byte)? {
            Ok(payload) => conversation.receive(payload, device),
            Err(_) => {
                count(&mut conversation.counters.corrupt);
                None
            }
        }
    }

    /// Takes a whole frame, with or without its delimiter; returns the frame to send, if any.
    pub fn receive_frame<D: Device>(&mut self, frame: &[u8], device: &mut D) -> Option<&[u8]> {
        let frame = frame.strip_suffix(&[DELIMITER]).unwrap_or(frame);
        for &byte in frame {
            // A delimiter inside ends a separate frame, which is invalid.
            if let Some(Err(_)) = self.decoder.push(byte) {
                count(&mut self.conversation.counters.corrupt);
            }
        }
        self.receive_byte(DELIMITER, device)
    }

    /// Encodes an unsolicited frame ([`Reply::Measured`]), for a timer that runs the control task.
    ///
    /// Returns `None` without a session, or if the message does not fit.
    pub fn unsolicited<'a>(
        &self,
        reply: &Reply,
        buffer: &'a mut [u8; FRAME_MAX],
    ) -> Option<&'a [u8]> {
        let session = self.conversation.session?;
        let header = to_host(session.number, session.sequence);
        frame::encode(header, reply, buffer).ok()
    }

    /// Returns whether the control task runs once per request and not by its timer. Before the first session it runs by
    /// its timer.
    pub const fn lock_step(&self) -> bool {
        matches!(self.conversation.session, Some(session) if session.lock_step)
    }

    /// Returns the counters of this side.
    pub const fn counters(&self) -> LinkCounters {
        self.conversation.counters
    }
}

/// State of the session without the bytes of the incoming frame.
#[derive(Clone, Debug)]
struct Conversation {
    boot: u32,
    session: Option<Session>,
    counters: LinkCounters,
    /// Frame of the last answer, to be repeated if it is lost.
    answer: [u8; FRAME_MAX],
    answer_length: usize,
    /// Frame of a refusal outside the session, which must not overwrite the last answer.
    refusal: [u8; REFUSAL_MAX],
}

#[derive(Clone, Copy, Debug)]
struct Session {
    /// Host's part of the session number.
    nonce: u32,
    number: u32,
    /// Number of the last answered request.
    sequence: u32,
    lock_step: bool,
}

impl Conversation {
    fn receive<D: Device>(&mut self, payload: &[u8], device: &mut D) -> Option<&[u8]> {
        let Some((header, message)) = frame::header(payload) else {
            count(&mut self.counters.unknown);
            return None;
        };
        if header.direction != Direction::ToDevice {
            count(&mut self.counters.echoed);
            return None;
        }
        let request = frame::message(message);
        if let (0, Some(Request::Hello { version, lock_step })) = (header.sequence, &request) {
            return self.hello(header, *version, *lock_step, device);
        }
        let Some(session) = self
            .session
            .filter(|session| session.number == header.session)
        else {
            count(&mut self.counters.foreign);
            return self.refuse(header, Refusal::NoSession);
        };
        match Place::of(header.sequence, session.sequence) {
            Place::Same => {
                count(&mut self.counters.duplicate);
                self.last_answer()
            }
            Place::Next => {
                self.session = Some(Session {
                    sequence: header.sequence,
                    ..session
                });
                let reply = self.reply(request, session.lock_step, device);
                self.answer(header, &reply)
            }
            Place::Beyond => {
                count(&mut self.counters.skipped);
                self.refuse(
                    header,
                    Refusal::Skipped {
                        expected: session.sequence.wrapping_add(1),
                        found: header.sequence,
                    },
                )
            }
            Place::Before => {
                count(&mut self.counters.stale);
                None
            }
        }
    }

    fn hello<D: Device>(
        &mut self,
        header: Header,
        version: u16,
        lock_step: bool,
        device: &mut D,
    ) -> Option<&[u8]> {
        if version != VERSION {
            count(&mut self.counters.unknown);
            return self.refuse(header, Refusal::Version { device: VERSION });
        }
        match self.session {
            Some(session) if session.nonce == header.session => {
                if session.sequence == 0 {
                    count(&mut self.counters.duplicate);
                    self.last_answer()
                } else {
                    count(&mut self.counters.stale);
                    None
                }
            }
            _ => {
                self.session = Some(Session {
                    nonce: header.session,
                    number: session_number(header.session, self.boot),
                    sequence: 0,
                    lock_step,
                });
                count(&mut self.counters.accepted);
                let mut identity = device.open(lock_step);
                identity.boot = self.boot;
                self.answer(header, &Reply::Identity(identity))
            }
        }
    }

    fn reply<D: Device>(
        &mut self,
        request: Option<Request>,
        lock_step: bool,
        device: &mut D,
    ) -> Reply {
        let Some(request) = request else {
            count(&mut self.counters.unknown);
            return Reply::Refused(Refusal::UnknownMessage);
        };
        count(&mut self.counters.accepted);
        match request {
            Request::Sample(_) if !lock_step => Reply::Refused(Refusal::NotInLockStep),
            Request::Counters => Reply::Counters(self.counters),
            // Hello within a session, where its number is not 0.
            Request::Hello { .. } => Reply::Refused(Refusal::UnknownMessage),
            request => device.answer(&request),
        }
    }

    fn answer(&mut self, request: Header, reply: &Reply) -> Option<&[u8]> {
        let header = to_host(request.session, request.sequence);
        self.answer_length = match frame::encode(header, reply, &mut self.answer) {
            Ok(frame) => frame.len(),
            // No message is too long, as a test shows. Without an answer the host would report an error.
            Err(_) => 0,
        };
        self.last_answer()
    }

    fn last_answer(&self) -> Option<&[u8]> {
        self.answer
            .get(..self.answer_length)
            .filter(|frame| !frame.is_empty())
    }

    fn refuse(&mut self, request: Header, refusal: Refusal) -> Option<&[u8]> {
        let header = to_host(request.session, request.sequence);
        frame::encode(header, &Reply::Refused(refusal), &mut self.refusal).ok()
    }
}

const fn to_host(session: u32, sequence: u32) -> Header {
    Header {
        direction: Direction::ToHost,
        session,
        sequence,
    }
}
