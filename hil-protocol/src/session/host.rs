//! Host's side of a session.

use super::{Place, session_number};
use crate::counters::{LinkCounters, count};
use crate::frame::{self, DELIMITER, Decoder, Direction, FRAME_MAX, Header, TooLong};
use crate::message::{Identity, Refusal, Reply, Request, VERSION};

/// Host's side of a link: bytes in, bytes out. The transport has the deadline for an answer; it calls
/// [`HostSession::again`] when the deadline has passed.
///
/// ```text
///          open          Identity         request            answer
///  closed ──────► opening ──────► open ◄──────────► waiting ◄──────┐
///    ▲             │   again ↺              again ↺    │           │ older answers, damaged ones and
///    └─────────────┴───────────────────────────────────┘           │ those of other sessions are counted
///      too many tries, or the device ended the session             ┘
/// ```
#[derive(Clone, Debug)]
pub struct HostSession {
    decoder: Decoder,
    conversation: Conversation,
}

/// Received event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// The session was opened.
    Opened(Identity),
    /// Answer to the last request.
    Reply(Reply),
    /// Unsolicited message.
    Unsolicited(Reply),
}

/// Reason why a session ended, or could not continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum HostError {
    /// No answer after the maximum number of tries. The session is closed.
    #[error(
        "request {sequence} was sent {tries} times and not answered: is the device powered, connected and running?"
    )]
    Unanswered {
        /// Number of the request in the session.
        sequence: u32,
        /// Number of times it was sent.
        tries: u32,
    },
    /// The device ended the session, which is closed.
    #[error("the session ended at request {sequence}: {refusal}")]
    Ended {
        /// Number of the request in the session.
        sequence: u32,
        /// Refusal of the device.
        refusal: Refusal,
    },
    /// A request was made while another one waits for its answer.
    #[error("request {sequence} still waits for its answer")]
    Waiting {
        /// Number of the waiting request in the session.
        sequence: u32,
    },
    /// The call needs a request without an answer, and there is none.
    #[error("no request waits for an answer: open a session, or make one")]
    Idle,
    /// A request was made without a session.
    #[error("no session is open")]
    Closed,
    /// The message is too long for a frame.
    #[error(transparent)]
    TooLong(#[from] TooLong),
}

impl HostSession {
    /// Creates the side without a session. Each request is sent at most `tries` times.
    pub const fn new(tries: u32) -> Self {
        Self {
            decoder: Decoder::new(),
            conversation: Conversation {
                phase: Phase::Closed,
                sequence: 0,
                tries: 0,
                tries_max: tries,
                counters: LinkCounters::ZERO,
                frame: [0; FRAME_MAX],
                frame_length: 0,
            },
        }
    }

    /// Returns the frame that opens a session, in every state. `nonce` has to differ from session to session, for
    /// example a clock or a random number.
    ///
    /// # Errors
    /// Returns no error: a Hello always fits into a frame.
    pub fn open(&mut self, nonce: u32, lock_step: bool) -> Result<&[u8], HostError> {
        let hello = Request::Hello {
            version: VERSION,
            lock_step,
        };
        self.conversation.phase = Phase::Opening { nonce };
        self.conversation.sequence = 0;
        self.conversation.send(nonce, &hello)
    }

    /// Returns the frame of a request.
    ///
    /// # Errors
    /// Returns an error if no session is open, another request waits, or the message does not fit.
    pub fn request(&mut self, request: &Request) -> Result<&[u8], HostError> {
        let conversation = &mut self.conversation;
        match conversation.phase {
            Phase::Closed | Phase::Opening { .. } => Err(HostError::Closed),
            Phase::Waiting { .. } => Err(HostError::Waiting {
                sequence: conversation.sequence,
            }),
            Phase::Open { number } => {
                conversation.phase = Phase::Waiting { number };
                conversation.sequence = conversation.sequence.wrapping_add(1);
                conversation.send(number, request)
            }
        }
    }

    /// Returns the same frame again, because no answer came in time.
    ///
    /// # Errors
    /// Returns an error if it was sent the maximum number of times, which closes the session, or if no request waits.
    pub fn again(&mut self) -> Result<&[u8], HostError> {
        let conversation = &mut self.conversation;
        if !matches!(
            conversation.phase,
            Phase::Opening { .. } | Phase::Waiting { .. }
        ) {
            return Err(HostError::Idle);
        }
        if conversation.tries >= conversation.tries_max {
            conversation.phase = Phase::Closed;
            return Err(HostError::Unanswered {
                sequence: conversation.sequence,
                tries: conversation.tries,
            });
        }
        conversation.tries = conversation.tries.saturating_add(1);
        count(&mut conversation.counters.repeated);
        Ok(conversation.frame())
    }

    /// Takes one byte from the wire; returns the event, once it is complete.
    ///
    /// # Errors
    /// Returns an error if the device ended the session.
    pub fn receive_byte(&mut self, byte: u8) -> Result<Option<Event>, HostError> {
        let Self {
            decoder,
            conversation,
        } = self;
        match decoder.push(byte) {
            None => Ok(None),
            Some(Ok(payload)) => conversation.receive(payload),
            Some(Err(_)) => {
                count(&mut conversation.counters.corrupt);
                Ok(None)
            }
        }
    }

    /// Takes a whole frame, with or without its delimiter.
    ///
    /// # Errors
    /// Returns an error if the device ended the session.
    pub fn receive_frame(&mut self, frame: &[u8]) -> Result<Option<Event>, HostError> {
        let frame = frame.strip_suffix(&[DELIMITER]).unwrap_or(frame);
        for &byte in frame {
            // A delimiter inside ends a separate frame, which is invalid.
            if let Some(Err(_)) = self.decoder.push(byte) {
                count(&mut self.conversation.counters.corrupt);
            }
        }
        self.receive_byte(DELIMITER)
    }

    /// Returns whether a request may be made.
    pub const fn is_open(&self) -> bool {
        matches!(self.conversation.phase, Phase::Open { .. })
    }

    /// Returns the counters of this side.
    pub const fn counters(&self) -> LinkCounters {
        self.conversation.counters
    }
}

/// State of the session without the bytes of the incoming frame.
#[derive(Clone, Debug)]
struct Conversation {
    phase: Phase,
    /// Number of the last request.
    sequence: u32,
    /// Number of times it was sent.
    tries: u32,
    tries_max: u32,
    counters: LinkCounters,
    /// Frame of the last request, to be repeated if it or its answer is lost.
    frame: [u8; FRAME_MAX],
    frame_length: usize,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    Closed,
    /// Hello was sent.
    Opening {
        nonce: u32,
    },
    /// A request may be made.
    Open {
        number: u32,
    },
    /// A request waits for its answer.
    Waiting {
        number: u32,
    },
}

impl Conversation {
    fn send(&mut self, session: u32, request: &Request) -> Result<&[u8], HostError> {
        let header = Header {
            direction: Direction::ToDevice,
            session,
            sequence: self.sequence,
        };
        self.tries = 1;
        self.frame_length = frame::encode(header, request, &mut self.frame)?.len();
        Ok(self.frame())
    }

    fn frame(&self) -> &[u8] {
        self.frame.get(..self.frame_length).unwrap_or(&[])
    }

    fn receive(&mut self, payload: &[u8]) -> Result<Option<Event>, HostError> {
        let Some((header, message)) = frame::header(payload) else {
            count(&mut self.counters.unknown);
            return Ok(None);
        };
        if header.direction != Direction::ToHost {
            count(&mut self.counters.echoed);
            return Ok(None);
        }
        let Some(reply) = frame::message(message) else {
            count(&mut self.counters.unknown);
            return Ok(None);
        };
        match self.phase {
            Phase::Opening { nonce } if header.session == nonce && header.sequence == 0 => {
                self.opened(nonce, reply)
            }
            Phase::Open { number } | Phase::Waiting { number } if header.session == number => {
                self.within_session(number, header.sequence, reply)
            }
            Phase::Closed | Phase::Opening { .. } | Phase::Open { .. } | Phase::Waiting { .. } => {
                count(&mut self.counters.foreign);
                Ok(None)
            }
        }
    }

    fn opened(&mut self, nonce: u32, reply: Reply) -> Result<Option<Event>, HostError> {
        match reply {
            Reply::Identity(identity) => {
                count(&mut self.counters.accepted);
                self.phase = Phase::Open {
                    number: session_number(nonce, identity.boot),
                };
                Ok(Some(Event::Opened(identity)))
            }
            Reply::Refused(refusal) => Err(self.ended(refusal)),
            _ => {
                count(&mut self.counters.unknown);
                Ok(None)
            }
        }
    }

    fn within_session(
        &mut self,
        number: u32,
        sequence: u32,
        reply: Reply,
    ) -> Result<Option<Event>, HostError> {
        match (reply, Place::of(sequence, self.sequence), self.phase) {
            // This applies to any request: a device that does not know the session now will not know it later.
            (Reply::Refused(refusal @ Refusal::NoSession), ..) => Err(self.ended(refusal)),
            (reply @ Reply::Measured { .. }, ..) => Ok(Some(Event::Unsolicited(reply))),
            (
                Reply::Refused(refusal @ Refusal::Skipped { .. }),
                Place::Same,
                Phase::Waiting { .. },
            ) => Err(self.ended(refusal)),
            (reply, Place::Same, Phase::Waiting { .. }) => {
                count(&mut self.counters.accepted);
                self.phase = Phase::Open { number };
                Ok(Some(Event::Reply(reply)))
            }
            (_, Place::Same, _) => {
                count(&mut self.counters.duplicate);
                Ok(None)
            }
            (_, Place::Before, _) => {
                count(&mut self.counters.stale);
                Ok(None)
            }
            (_, Place::Next | Place::Beyond, _) => {
                count(&mut self.counters.foreign);
                Ok(None)
            }
        }
    }

    fn ended(&mut self, refusal: Refusal) -> HostError {
        self.phase = Phase::Closed;
        HostError::Ended {
            sequence: self.sequence,
            refusal,
        }
    }
}
