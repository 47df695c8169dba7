//! Memory that exists before the image and beside it, at the addresses of `memory.x`.

use core::sync::atomic::AtomicU32;

use firmware::{RETAINED_WORDS, Retained};
use hil_protocol::mailbox;

/// Words of the page of pins.
pub(super) const PINS: usize = 64;

// SAFETY: the linker puts each symbol at the start of a region of RAM of its own (`memory.x`), which is aligned, larger than
// the type, and touched by nobody in the image but through these names. Words that others (the host, an earlier life) write
// as well are atomic.
unsafe extern "C" {
    /// Frames from and to the host.
    #[link_name = "mailbox"]
    pub(super) safe static MAILBOX: [AtomicU32; mailbox::WORDS];
    /// What the sensors show and the coils get.
    #[link_name = "pins"]
    pub(super) safe static PIN_WORDS: [AtomicU32; PINS];
    #[link_name = "retained"]
    safe static RETAINED: [AtomicU32; RETAINED_WORDS];
}

/// The words that a warm reset leaves alone.
pub(crate) fn retained() -> Retained<'static> {
    Retained::new(&RETAINED)
}
