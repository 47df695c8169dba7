//! RAM that a warm reset does not change, at the addresses of the board's `board.x`.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use firmware::{BLACK_BOX_WORDS, RETAINED_WORDS, Retained};

use crate::boards::board::BLACK_BOX_ROOM;

// SAFETY: the linker puts each symbol at the start of a region of RAM of its own (`board.x`), which is aligned, larger
// than the type, and accessed by the image only through these names; any bits are a value of the types. Words that an
// earlier run also wrote are atomic, and the reference to the black box is created once.
unsafe extern "C" {
    #[link_name = "retained"]
    safe static RETAINED: [AtomicU32; RETAINED_WORDS];
    #[link_name = "black_box"]
    static mut BLACK_BOX: [u32; BLACK_BOX_WORDS];
}

const _: () = assert!(BLACK_BOX_WORDS * 4 <= BLACK_BOX_ROOM);

/// Returns the black box's words, on the first call only.
pub(crate) fn black_box() -> Option<&'static mut [u32; BLACK_BOX_WORDS]> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    if TAKEN.swap(true, Ordering::Relaxed) {
        return None;
    }
    // SAFETY: as above; this line runs at most once.
    unsafe { (&raw mut BLACK_BOX).as_mut() }
}

/// Returns the words that the image stores for its next start.
pub(crate) fn retained() -> Retained<'static> {
    Retained::new(&RETAINED)
}
