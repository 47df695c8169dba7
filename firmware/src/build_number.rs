//! Build number, computed from the image.

use core::slice;

use hil_protocol::crc32;

/// Returns the CRC-32 over code and constants in flash, from `__stext` to `__erodata`. With the ELF a host can check
/// whether it is the running build. A damaged flash gives another number.
pub(crate) fn build_number() -> u32 {
    unsafe extern "C" {
        static __stext: u8;
        static __erodata: u8;
    }
    let start = &raw const __stext;
    let length = (&raw const __erodata).addr().saturating_sub(start.addr());
    // SAFETY: the linker script of cortex-m-rt puts `.text` and `.rodata` one after the other into flash, between these
    // two symbols; no code writes there.
    crc32::digest(unsafe { slice::from_raw_parts(start, length) })
}
