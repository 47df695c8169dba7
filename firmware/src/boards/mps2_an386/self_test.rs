//! Self-test by semihosting: text on QEMU's standard output, the verdict as its exit status.

use cortex_m_semihosting::{debug, hio};
use firmware::self_test::{self, NotShown, Watcher};

use super::pins;
use crate::stack;

/// Returns whether the program that started the machine requests the self-test.
pub(super) fn is_wanted() -> bool {
    pins::self_test_is_wanted()
}

/// Runs the self-test with the coils off, and ends.
pub(super) fn run() -> ! {
    let is_shown = hio::hstdout().is_ok_and(|out| shows_all(&mut Semihosting { out }));
    debug::exit(if is_shown {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    // A debugger may let the run continue after the exit. Nothing is left to do, and the coils are off.
    loop {
        core::hint::spin_loop();
    }
}

/// Shows the digests and the stack usage; returns whether all of it was shown.
fn shows_all(watcher: &mut Semihosting) -> bool {
    if self_test::run(watcher, |_, _| 0).is_err() {
        return false;
    }
    let (used, reserved) = stack::used_of_reserved();
    self_test::show_stack(watcher, used, reserved).is_ok()
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
