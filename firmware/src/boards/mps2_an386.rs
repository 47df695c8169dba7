//! Arm MPS2 with the AN386 image: the Cortex-M4F machine that QEMU emulates (`-machine mps2-an386`).
//!
//! It has no coil drivers. Its two user LEDs stand for them: LED 0 lit is current in the fill valve's coil, LED 1 in the
//! vent valve's. Text and the verdict leave by semihosting: text on QEMU's standard output, the verdict as its exit status.

use core::fmt::{self, Write};
use core::panic::PanicInfo;
use core::ptr;

use cortex_m_rt::{ExceptionFrame, entry, exception};
use cortex_m_semihosting::{debug, hio};

use crate::board::{Board, Verdict};

/// The LED register of the board's FPGA (AN386, "FPGA system control and I/O"): bit 0 is LED 0, bit 1 is LED 1.
const LEDS: *mut u32 = 0x4002_8000 as *mut u32;

/// Longest line that leaves in one piece, in bytes; a longer one leaves in several.
const LINE_LENGTH: usize = 128;

struct Mps2An386;

impl Board for Mps2An386 {
    fn coils_off(&mut self) {
        // SAFETY: the address is a device register of this machine, aligned and always present; writing it only switches
        // LEDs. No other code writes it, and a volatile write is not removed.
        unsafe { ptr::write_volatile(LEDS, 0) }
    }

    fn show(&mut self, line: fmt::Arguments<'_>) -> fmt::Result {
        let out = hio::hstdout().map_err(|()| fmt::Error)?;
        let mut pieces = Pieces {
            out,
            held: [0; LINE_LENGTH],
            length: 0,
        };
        writeln!(pieces, "{line}")?;
        pieces.send()
    }

    fn end(&mut self, verdict: Verdict) -> ! {
        debug::exit(match verdict {
            Verdict::Passed => debug::EXIT_SUCCESS,
            Verdict::Failed => debug::EXIT_FAILURE,
        });
        // A debugger may let the run continue after the exit. There is nothing left to do, and the coils are off.
        loop {
            core::hint::spin_loop();
        }
    }
}

/// Gathers text, because each write by semihosting stops the machine and costs a round trip to the watcher.
struct Pieces {
    out: hio::HostStream,
    held: [u8; LINE_LENGTH],
    length: usize,
}

impl Pieces {
    fn send(&mut self) -> fmt::Result {
        let sent = self.out.write_all(&self.held[..self.length]);
        self.length = 0;
        sent.map_err(|()| fmt::Error)
    }
}

impl fmt::Write for Pieces {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for &byte in text.as_bytes() {
            if self.length == LINE_LENGTH {
                self.send()?;
            }
            self.held[self.length] = byte;
            self.length += 1;
        }
        Ok(())
    }
}

#[entry]
fn main() -> ! {
    crate::live(&mut Mps2An386, |_, _| 0)
}

/// Safe first, words second. Whether the words get out cannot matter any more, so that result is dropped.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let mut board = Mps2An386;
    board.coils_off();
    let _ = board.show(format_args!("{info}"));
    board.end(Verdict::Failed)
}

/// A fault is a panic that the machine noticed.
// SAFETY: cortex-m-rt demands the signature. The handler runs above all other code, never returns, and touches only the LED
// register and semihosting.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    let mut board = Mps2An386;
    board.coils_off();
    let _ = board.show(format_args!("hard fault at {:#010x}", frame.pc()));
    board.end(Verdict::Failed)
}
