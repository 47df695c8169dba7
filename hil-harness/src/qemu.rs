//! The very image that would be flashed, on an emulated machine: QEMU's `mps2-an386`, a Cortex-M4F.
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

/// Why there is no emulated device.
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
    /// The emulator or what it needs cannot be set up.
    #[error("{what}: {error}")]
    Io {
        /// What was tried.
        what: &'static str,
        /// What the operating system says.
        error: io::Error,
    },
    /// The memory cannot be shared.
    #[error("the emulated machine's memory cannot be shared: {reason}")]
    Memory {
        /// Why.
        reason: String,
    },
    /// The emulator did not connect.
    #[error("the emulator did not connect its UART within {waited_ms} ms; it printed:\n{printed}")]
    NotConnected {
        /// How long was waited \[ms\].
        waited_ms: u128,
        /// What it printed.
        printed: String,
    },
    /// The image does not answer.
    #[error("{image}: {error}")]
    Link {
        /// The image's file.
        image: String,
        /// Why.
        error: Box<LinkError>,
    },
}

/// Starts the image and opens a session in lock step with it over `wire`.
///
/// # Errors
/// QEMU is missing or fails, or the image does not answer.
pub fn start(image: Image, wire: Wire) -> Result<Framed<QemuLink>, QemuError> {
    open(image, wire, Clock::Host, Pace::LockStep)
}

/// Starts the image on a machine with this clock, and opens a session with it over `wire`.
///
/// # Errors
/// As [`start`].
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

/// How long is waited for an emulated device. A busy machine may leave an emulator without processor for seconds.
pub const PATIENCE: Patience = Patience {
    reply: Duration::from_secs(3),
    tries: 3,
    start: Duration::from_secs(30),
};
