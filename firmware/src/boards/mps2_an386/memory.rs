//! Memory that exists before the image and beside it, at the addresses of `board.x`.

use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering};

use firmware::{BLACK_BOX_WORDS, RETAINED_WORDS, Retained};
use hil_protocol::mailbox;

/// Words of the page of pins.
pub(super) const PINS: usize = 64;
/// Two pages of what stands for flash.
pub(super) const SETTINGS_BYTES: usize = 4096;

// SAFETY: the linker puts each symbol at the start of a region of RAM of its own (`board.x`), which is aligned, larger than
// the type, and touched by nobody in the image but through these names. Words that others (the host, an earlier life) write
// as well are atomic.
unsafe extern "C" {
    /// Frames from and to the host.
    #[link_name = "mailbox"]
    pub(super) safe static MAILBOX: [AtomicU32; mailbox::WORDS];
    /// What the sensors show and the coils get.
    #[link_name = "pins"]
    pub(super) safe static PIN_WORDS: [AtomicU32; PINS];
    /// Stands for flash.
    #[link_name = "settings"]
    pub(super) safe static SETTINGS: [AtomicU8; SETTINGS_BYTES];
    #[link_name = "retained"]
    safe static RETAINED: [AtomicU32; RETAINED_WORDS];
    #[link_name = "black_box"]
    static mut BLACK_BOX: [u32; BLACK_BOX_WORDS];
}

// The room that `board.x` gives it.
const _: () = assert!(BLACK_BOX_WORDS * 4 <= 28 * 1024);

/// The black box's words, for the first who asks.
pub(super) fn black_box() -> Option<&'static mut [u32; BLACK_BOX_WORDS]> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    if TAKEN.swap(true, Ordering::Relaxed) {
        return None;
    }
    // SAFETY: as above; `u32` allows any bits, and this is reached once.
    unsafe { (&raw mut BLACK_BOX).as_mut() }
}

/// The words that a warm reset leaves alone.
pub(crate) fn retained() -> Retained<'static> {
    Retained::new(&RETAINED)
}
