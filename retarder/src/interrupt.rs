//! Ctrl-C, SIGTERM and SIGHUP while an output file is being written.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Exit status of a process that a second signal ends.
const ENDED_BY_SIGNAL: i32 = 130;

static IS_WATCHED: AtomicBool = AtomicBool::new(false);
static IS_RAISED: AtomicBool = AtomicBool::new(false);

/// Returns the flag that such a signal sets, so that the unfinished file can be removed. A second signal ends the
/// process, since code that waits for input does not read the flag. All parts of a command share the flag.
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

/// Returns the failure "interrupted" if the flag is set.
pub(crate) fn check(is_interrupted: &AtomicBool) -> Result<(), Failure> {
    if is_interrupted.load(Ordering::Relaxed) {
        Err(Failure::Interrupted)
    } else {
        Ok(())
    }
}
