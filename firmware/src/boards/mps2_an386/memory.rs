//! Memory shared with the host, at the addresses of `board.x`.

use core::sync::atomic::{AtomicU8, AtomicU32};

use hil_protocol::mailbox;

/// Number of words of the pin memory.
pub(super) const PINS: usize = 64;
/// Size of the simulated flash: two pages (bytes).
pub(super) const SETTINGS_BYTES: usize = 4096;

// SAFETY: the linker puts each symbol at the start of a region of RAM of its own (`board.x`), which is aligned, larger
// than the type, and accessed by the image only through these names. Words that the host also writes are atomic.
unsafe extern "C" {
    /// Frames from and to the host.
    #[link_name = "mailbox"]
    pub(super) safe static MAILBOX: [AtomicU32; mailbox::WORDS];
    /// Values of the sensors and duty cycles of the coils.
    #[link_name = "pins"]
    pub(super) safe static PIN_WORDS: [AtomicU32; PINS];
    /// Simulated flash.
    #[link_name = "settings"]
    pub(super) safe static SETTINGS: [AtomicU8; SETTINGS_BYTES];
}
