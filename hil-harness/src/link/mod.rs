//! Transport of requests to a device and of its replies.
//!
//! ```text
//! Direct:                 Request ------------------------------> Device        no frames
//! Framed<Transport>:      Request -> HostSession -> frame -> wire -> DeviceSession -> Device
//! ```
//!
//! The wall clock is used only here in this crate, and only to limit waiting times: no result depends on it.

mod direct;
mod disturbed;
mod error;
mod framed;
mod loopback;
mod serial;
mod transport;

use hil_protocol::{Reply, Request};

pub use direct::Direct;
pub use disturbed::{Disturbances, Disturbed};
pub use error::{LastWords, LinkError};
pub use framed::{Framed, Pace, Patience};
pub use loopback::Loopback;
pub use serial::{BAUD_RATE, SerialError, SerialPort};
pub use transport::{Stream, TimedStream, Transport, TransportError};

/// Link to a device, in lock step.
pub trait Link {
    /// Returns the identity of the device and of its link, for the record of a run.
    fn identity(&self) -> String;

    /// Sends one request to the device and waits for its reply.
    ///
    /// # Errors
    /// Returns an error if no reply came in time, or the device refused.
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError>;

    /// Returns the log of the device since the last call, decoded, oldest line first.
    ///
    /// # Errors
    /// Returns the same errors as [`Link::ask`].
    fn take_log(&mut self) -> Result<Vec<String>, LinkError>;
}
