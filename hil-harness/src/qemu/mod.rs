//! Image on an emulated machine, the same image that would be flashed: QEMU's `mps2-an386`, a Cortex-M4F.
//!
//! ```text
//!  Framed -- Wire::Mailbox: frames through memory that both map    [`SharedMemory`]
//!        \-- Wire::Uart:    frames byte by byte through a socket   [`Stream`](crate::link::Stream)
//!                           \-> [`Emulator`]: the child process, stopped when this value goes
//! ```

mod emulator;
mod mailbox;
mod memory;
mod wire;

use std::io;
use std::time::Duration;

use crate::image::Image;
use crate::link::{Framed, LinkError, Pace, Patience};

pub use emulator::{Clock, Emulator};
pub use memory::SharedMemory;
pub use wire::{QemuLink, Wire};

/// Reason why there is no emulated device.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum QemuError {
    /// The emulator is not installed.
    #[error(
        "{program} is not on this machine: `cargo xtask setup` installs it (Debian's package is qemu-system-arm)"
    )]
    NotInstalled {
        /// Name of the program.
        program: &'static str,
    },
    /// The emulator or its environment cannot be set up.
    #[error("{what}: {error}")]
    Io {
        /// Step that failed.
        what: &'static str,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The memory cannot be shared.
    #[error("the emulated machine's memory cannot be shared: {reason}")]
    Memory {
        /// Reason of the failure.
        reason: String,
    },
    /// The emulator did not connect.
    #[error("the emulator did not connect its UART within {waited_ms} ms; it printed:\n{printed}")]
    NotConnected {
        /// Waiting time (ms).
        waited_ms: u128,
        /// Output of the emulator.
        printed: String,
    },
    /// The image does not answer.
    #[error("{image}: {error}")]
    Link {
        /// File of the image.
        image: String,
        /// Error of the link.
        error: Box<LinkError>,
    },
}

/// Starts the image and opens a session in lock step with it over `wire`.
///
/// # Errors
/// Returns an error if QEMU is missing or fails, or the image does not answer.
pub fn start(image: Image, wire: Wire) -> Result<Framed<QemuLink>, QemuError> {
    open(image, wire, Clock::Host, Pace::LockStep)
}

/// Starts the image on a machine with this clock, and opens a session with it over `wire`.
///
/// # Errors
/// Returns the same errors as [`start`].
pub fn open(
    image: Image,
    wire: Wire,
    clock: Clock,
    pace: Pace,
) -> Result<Framed<QemuLink>, QemuError> {
    let link = QemuLink::start(&image, wire, clock)?;
    let name = image.path().display().to_string();
    Framed::open(link, pace, PATIENCE, image.into_log()).map_err(|error| QemuError::Link {
        image: name,
        error: Box::new(error),
    })
}

/// Timeouts for an emulated device. A busy machine may leave an emulator without processor time for seconds.
pub const PATIENCE: Patience = Patience {
    reply: Duration::from_secs(3),
    tries: 3,
    start: Duration::from_secs(30),
};
