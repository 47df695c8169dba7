//! Every way out that is not the end of `main`: safe first, then the reason, then a reset.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use firmware::Farewell;

use crate::boards::board;
use crate::kept;

/// The one end of every life: coils off, the reason where the next life finds it, reset.
pub(crate) fn end(farewell: Farewell) -> ! {
    board::coils_off();
    kept::retained().say(farewell);
    SCB::sys_reset()
}

#[cfg(not(feature = "prove-panic-free"))]
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(Farewell::Panic {
        line: info.location().map_or(0, |location| location.line()),
    })
}

/// With this handler the image links only if nothing in it can panic.
#[cfg(feature = "prove-panic-free")]
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn this_image_can_panic() -> !;
    }
    // SAFETY: no such function exists; an image in which this call is left does not link.
    unsafe { this_image_can_panic() }
}

/// One panic in code that certainly runs.
#[cfg(feature = "panic-canary")]
pub(crate) fn sing() {
    use core::hint::black_box;
    black_box(black_box(&[0_u8; 4])[black_box(7)]);
}

/// A fault is a panic that the processor noticed.
// SAFETY: cortex-m-rt demands the signature. The handler runs above all other code, never returns, and touches only the
// outputs, the retained words and the reset.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(Farewell::Exception { pc: frame.pc() })
}
