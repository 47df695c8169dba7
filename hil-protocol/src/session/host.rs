//! The host's side.

use crate::counters::LinkCounters;
use crate::message::{Identity, Refusal, Reply, Request};

/// The host's side of a link.
#[derive(Clone, Debug)]
pub struct HostSession {
    counters: LinkCounters,
}

/// What came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// The session is open.
    Opened(Identity),
    /// The answer to the request that was sent last.
    Reply(Reply),
    /// What nobody asked for.
    Unasked(Reply),
}

/// Why a session ended, or did not go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HostError {
    /// No answer after so many tries.
    #[error(
        "request {sequence} was sent {tries} times and not answered: is the device powered, connected and running?"
    )]
    Unanswered {
        /// Its number in the session.
        sequence: u32,
        /// How often it was sent.
        tries: u32,
    },
    /// The device ended the session.
    #[error("the session ended at request {sequence}: {refusal}")]
    Ended {
        /// The request's number in the session.
        sequence: u32,
        /// What the device said.
        refusal: Refusal,
    },
    /// A request was made while another one waits for its answer.
    #[error("request {sequence} still waits for its answer")]
    Waiting {
        /// Its number in the session.
        sequence: u32,
    },
    /// A request was made without a session.
    #[error("no session is open")]
    Closed,
    /// A message that no frame can hold.
    #[error("the message does not fit into a frame")]
    TooLong,
}

impl HostSession {
    /// No session yet. Each request is sent `tries` times at most.
    pub const fn new(tries: u32) -> Self {
        let _ = tries;
        Self {
            counters: LinkCounters {
                accepted: 0,
                corrupt: 0,
                unknown: 0,
                echoed: 0,
                duplicate: 0,
                stale: 0,
                foreign: 0,
                skipped: 0,
                repeated: 0,
            },
        }
    }

    /// The frame that opens a session. `nonce` has to differ from session to session: a clock or a random number.
    ///
    /// # Errors
    /// None but those of [`HostSession::request`].
    pub fn open(&mut self, nonce: u32, lock_step: bool) -> Result<&[u8], HostError> {
        let _ = (nonce, lock_step);
        Err(HostError::Closed)
    }

    /// The frame of a request.
    ///
    /// # Errors
    /// No session is open, or another request waits.
    pub fn request(&mut self, request: &Request) -> Result<&[u8], HostError> {
        let _ = request;
        Err(HostError::Closed)
    }

    /// The same frame again, because no answer came in time.
    ///
    /// # Errors
    /// It was sent often enough; the session is closed.
    pub fn again(&mut self) -> Result<&[u8], HostError> {
        Err(HostError::Closed)
    }

    /// Takes one byte from the wire; returns what came, once it is complete.
    ///
    /// # Errors
    /// The device ended the session.
    pub fn receive_byte(&mut self, byte: u8) -> Result<Option<Event>, HostError> {
        let _ = byte;
        Ok(None)
    }

    /// Takes a whole frame, with or without its delimiter.
    ///
    /// # Errors
    /// The device ended the session.
    pub fn receive_frame(&mut self, frame: &[u8]) -> Result<Option<Event>, HostError> {
        let _ = frame;
        Ok(None)
    }

    /// What this side has seen.
    pub const fn counters(&self) -> LinkCounters {
        self.counters
    }
}
