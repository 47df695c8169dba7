//! Memory that exists before the image and beside it, at the addresses of `memory.x`.

use core::sync::atomic::AtomicU32;

use firmware::{RETAINED_WORDS, Retained};

// SAFETY: the linker puts the symbol at the start of a region of RAM of its own (`memory.x`), which is aligned, larger than
// the type, and touched by nobody in the image but through this name. The words that an earlier life wrote are atomic.
unsafe extern "C" {
    #[link_name = "retained"]
    safe static RETAINED: [AtomicU32; RETAINED_WORDS];
}

/// The words that a warm reset leaves alone.
pub(crate) fn retained() -> Retained<'static> {
    Retained::new(&RETAINED)
}
