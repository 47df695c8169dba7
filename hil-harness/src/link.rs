//! How a request reaches a device and its reply comes back.
//!
//! ```text
//! Direct:                 Request ------------------------------> Device        no frames
//! Framed<Transport>:      Request -> HostSession -> frame -> wire -> DeviceSession -> Device
//! ```
//!
//! The wall clock appears here and nowhere else in this crate, and only to bound waiting: no result depends on it.

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

/// A way to a device, in lock step.
pub trait Link {
    /// What answers, and over what; for the record of a run.
    fn identity(&self) -> String;

    /// Carries one request to the device and waits for its reply.
    ///
    /// # Errors
    /// No reply came in time, or the device refused.
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError>;

    /// What the device logged since the last call, decoded, oldest line first.
    ///
    /// # Errors
    /// As [`Link::ask`].
    fn take_log(&mut self) -> Result<Vec<String>, LinkError>;
}
