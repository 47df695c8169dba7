//! The self-test by semihosting: text on QEMU's standard output, the verdict as its exit status.

use cortex_m_semihosting::{debug, hio};
use firmware::self_test::{self, NotShown, Watcher};

use super::pins;

/// Whether whoever started the machine wants it.
pub(super) fn is_wanted() -> bool {
    pins::self_test_is_wanted()
}

/// Runs it, with the coils off, and ends.
pub(super) fn run() -> ! {
    let told =
        hio::hstdout().is_ok_and(|out| self_test::run(&mut Semihosting { out }, |_, _| 0).is_ok());
    debug::exit(if told {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    // A debugger may let the run continue after the exit. There is nothing left to do, and the coils are off.
    loop {
        core::hint::spin_loop();
    }
}

struct Semihosting {
    out: hio::HostStream,
}

impl Watcher for Semihosting {
    fn show(&mut self, line: &str) -> Result<(), NotShown> {
        let mut written = self.out.write_all(line.as_bytes());
        if written.is_ok() {
            written = self.out.write_all(b"\n");
        }
        written.map_err(|()| NotShown)
    }
}
