//! Handlers that end the run of the image: first the safe state, then the stored reason, then a reset.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use firmware::ResetReason;

use crate::boards::board;
use crate::retained_ram;

/// Ends the run: switches the coils off, stores the reason for the next start, and resets. Every end of a run calls
/// this function.
pub(crate) fn end(reset_reason: ResetReason) -> ! {
    board::coils_off();
    retained_ram::retained().say(reset_reason);
    SCB::sys_reset()
}

#[cfg(not(feature = "prove-panic-free"))]
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(ResetReason::Panic {
        line: info.location().map_or(0, |location| location.line()),
    })
}

/// Panic handler with which the image links only if nothing in it can panic.
#[cfg(feature = "prove-panic-free")]
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn this_image_can_panic() -> !;
    }
    // SAFETY: no such function exists; an image in which this call is left does not link.
    unsafe { this_image_can_panic() }
}

/// Panics; called from code that certainly runs.
#[cfg(feature = "panic-canary")]
pub(crate) fn sing() {
    use core::hint::black_box;
    black_box(black_box(&[0_u8; 4])[black_box(7)]);
}

/// Handles a fault exception, as a panic is handled.
// SAFETY: cortex-m-rt demands the signature. The handler runs above all other code, never returns, and touches only the
// outputs, the retained words and the reset.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(ResetReason::Exception { pc: frame.pc() })
}
