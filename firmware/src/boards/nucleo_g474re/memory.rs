//! Memory that exists before the image and beside it, at the addresses of `board.x`.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use firmware::{BLACK_BOX_WORDS, RETAINED_WORDS, Retained};

// SAFETY: the linker puts each symbol at the start of a region of its own (`board.x`), which is aligned, larger than the type,
// and touched by nobody in the image but through these names; any bits are a value of the types.
unsafe extern "C" {
    #[link_name = "retained"]
    safe static RETAINED: [AtomicU32; RETAINED_WORDS];
    #[link_name = "black_box"]
    static mut BLACK_BOX: [u32; BLACK_BOX_WORDS];
}

// The room that `board.x` gives it.
const _: () = assert!(BLACK_BOX_WORDS * 4 <= 23 * 1024);

/// The black box's words, for the first who asks.
pub(super) fn black_box() -> Option<&'static mut [u32; BLACK_BOX_WORDS]> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    if TAKEN.swap(true, Ordering::Relaxed) {
        return None;
    }
    // SAFETY: as above, and this is reached once.
    unsafe { (&raw mut BLACK_BOX).as_mut() }
}

/// The words that a warm reset leaves alone.
pub(crate) fn retained() -> Retained<'static> {
    Retained::new(&RETAINED)
}
