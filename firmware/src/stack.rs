//! Stack usage, measured by the paint of the start-up code.

use core::ptr;

/// Value with which the start-up code fills the stack before `main` (cortex-m-rt, `paint-stack`).
const PAINT: u32 = 0xcccc_cccc;

/// Returns the largest stack usage so far and the reserved size, in bytes.
///
/// It takes a few instructions per free word, too many for a sample.
pub(crate) fn used_of_reserved() -> (u32, u32) {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    let top = &raw const _stack_start;
    let mut lowest = &raw const _stack_end;
    let bytes = |from: *const u32| top.addr().saturating_sub(from.addr()) as u32;
    let reserved = bytes(lowest);
    // SAFETY: the stack lies between the two symbols (linker script of cortex-m-rt), aligned and readable; its used
    // part may change meanwhile, which a volatile read allows.
    while lowest < top && unsafe { ptr::read_volatile(lowest) } == PAINT {
        lowest = lowest.wrapping_add(1);
    }
    (bytes(lowest), reserved)
}
