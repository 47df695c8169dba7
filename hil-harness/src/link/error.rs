//! Errors of a request.

use core::fmt;

use hil_protocol::{HostError, Refusal, Reply, Request};

use super::transport::TransportError;

/// Reason why a request has no valid reply.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The device is silent: not powered, not connected, or hung.
    #[error(
        "no reply to {request} within {waited_ms} ms, though sent {tries} times: is the device powered, connected and \
         running?{said}"
    )]
    Silent {
        /// Request without a reply.
        request: String,
        /// Total waiting time (ms).
        waited_ms: u128,
        /// Number of times it was sent.
        tries: u32,
        /// Last output of the device.
        said: LastWords,
    },
    /// The bytes do not get through.
    #[error("{request}: {error}{said}")]
    Transport {
        /// Request without a reply.
        request: String,
        /// Error of the transport.
        error: TransportError,
        /// Last output of the device.
        said: LastWords,
    },
    /// The session ended.
    #[error("{request}: {error}{said}")]
    Session {
        /// Request without a reply.
        request: String,
        /// Error of the session.
        error: HostError,
        /// Last output of the device.
        said: LastWords,
    },
    /// The device refuses the request.
    #[error("{request} was refused: {refusal}")]
    Refused {
        /// Refused request.
        request: String,
        /// Reason of the refusal.
        refusal: Refusal,
    },
    /// The reply belongs to another kind of request.
    #[error("{request} was answered by {reply}: use the tools that came with the device's image")]
    Unexpected {
        /// Request that was sent.
        request: String,
        /// Reply that came.
        reply: String,
    },
}

impl LinkError {
    /// Creates the error of a refused `request`.
    pub fn refused(request: &Request, refusal: Refusal) -> Self {
        Self::Refused {
            request: name(request),
            refusal,
        }
    }

    /// Creates the error of a `request` with a reply of another kind.
    pub fn unexpected(request: &Request, reply: &Reply) -> Self {
        Self::Unexpected {
            request: name(request),
            reply: first_word(&format!("{reply:?}")),
        }
    }
}

/// Returns the name of a request in an error.
pub(super) fn name(request: &Request) -> String {
    match request {
        Request::Sample(sensors) => format!("sample {}", sensors.sample),
        other => format!("request {}", first_word(&format!("{other:?}"))),
    }
}

fn first_word(text: &str) -> String {
    text.split(|character: char| !character.is_alphanumeric())
        .next()
        .unwrap_or_default()
        .to_owned()
}

/// Last lines that a device logged, and those that its emulator printed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LastWords(pub Vec<String>);

impl fmt::Display for LastWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("; it has logged nothing");
        }
        f.write_str("; its last words:")?;
        self.0.iter().try_for_each(|line| write!(f, "\n  | {line}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_named_by_its_sample_or_its_first_word() {
        assert_eq!(name(&Request::Settings { first: 3 }), "request Settings");
        assert_eq!(name(&Request::Counters), "request Counters");
    }

    #[test]
    fn last_words_stand_one_to_a_line() {
        let said = LastWords(vec!["one".to_owned(), "two".to_owned()]);
        assert_eq!(said.to_string(), "; its last words:\n  | one\n  | two");
        assert_eq!(LastWords::default().to_string(), "; it has logged nothing");
    }
}
