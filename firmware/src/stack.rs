//! How deep the stack was used, by the paint that the start-up code gave it.

use core::ptr;

/// What the start-up code fills the stack with before `main` (cortex-m-rt, `paint-stack`).
const PAINT: u32 = 0xcccc_cccc;

/// The deepest use so far and the room there is, in bytes.
///
/// Takes a few instructions per free word: not for a sample.
pub(crate) fn used_of_reserved() -> (u32, u32) {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    let top = &raw const _stack_start;
    let mut lowest = &raw const _stack_end;
    let bytes = |from: *const u32| top.addr().saturating_sub(from.addr()) as u32;
    let reserved = bytes(lowest);
    // SAFETY: between the two symbols lies the stack (linker script of cortex-m-rt), aligned and readable; what is in use of it
    // may change meanwhile, which a volatile read allows.
    while lowest < top && unsafe { ptr::read_volatile(lowest) } == PAINT {
        lowest = lowest.wrapping_add(1);
    }
    (bytes(lowest), reserved)
}
