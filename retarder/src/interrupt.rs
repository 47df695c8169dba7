//! Ctrl-C, SIGTERM and SIGHUP while an output file is under way.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Exit status of a process that a second signal ends at once.
const ENDED_BY_SIGNAL: i32 = 130;

static IS_WATCHED: AtomicBool = AtomicBool::new(false);
static IS_RAISED: AtomicBool = AtomicBool::new(false);

/// Becomes true at such a signal, so that the file under way can be removed. A second one ends the process at once, for
/// what waits for input sees no flag. Every part of a command has the same flag.
pub(crate) fn flag() -> Result<&'static AtomicBool, Failure> {
    if !IS_WATCHED.swap(true, Ordering::Relaxed) {
        ctrlc::set_handler(|| {
            if IS_RAISED.swap(true, Ordering::Relaxed) {
                process::exit(ENDED_BY_SIGNAL);
            }
        })?;
    }
    Ok(&IS_RAISED)
}

/// Ends what may be ended here.
pub(crate) fn check(is_interrupted: &AtomicBool) -> Result<(), Failure> {
    if is_interrupted.load(Ordering::Relaxed) {
        Err(Failure::Interrupted)
    } else {
        Ok(())
    }
}
