//! Ctrl-C, SIGTERM and SIGHUP during long work.

use std::process;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Exit status of a process that a second signal ends.
const ENDED_BY_SIGNAL: i32 = 130;

static IS_WATCHED: AtomicBool = AtomicBool::new(false);
static IS_RAISED: AtomicBool = AtomicBool::new(false);
/// Whether the present work writes no file.
static WRITES_NOTHING: AtomicBool = AtomicBool::new(false);
/// End of the process with a failure.
static END: OnceLock<fn(&Failure) -> !> = OnceLock::new();

/// Sets how the process ends with a failure.
pub(crate) fn set_end(end: fn(&Failure) -> !) {
    let _ = END.set(end);
}

/// Returns the flag that such a signal sets, so that the unfinished file can be removed. A second signal ends the
/// process, since code that waits for input does not read the flag. All parts of a command share the flag.
pub(crate) fn flag() -> Result<&'static AtomicBool, Failure> {
    if !IS_WATCHED.swap(true, Ordering::Relaxed) {
        ctrlc::set_handler(|| {
            if WRITES_NOTHING.load(Ordering::Relaxed)
                && let Some(end) = END.get()
            {
                end(&Failure::Interrupted);
            }
            if IS_RAISED.swap(true, Ordering::Relaxed) {
                process::exit(ENDED_BY_SIGNAL);
            }
        })?;
    }
    Ok(&IS_RAISED)
}

/// Runs `work`, which writes no file: a signal ends the process at once, even in the middle of a long fit.
pub(crate) fn at_once<T>(work: impl FnOnce() -> T) -> Result<T, Failure> {
    check(flag()?)?;
    let before = WRITES_NOTHING.swap(true, Ordering::Relaxed);
    let done = work();
    WRITES_NOTHING.store(before, Ordering::Relaxed);
    Ok(done)
}

/// Returns the failure "interrupted" if the flag is set.
pub(crate) fn check(is_interrupted: &AtomicBool) -> Result<(), Failure> {
    if is_interrupted.load(Ordering::Relaxed) {
        Err(Failure::Interrupted)
    } else {
        Ok(())
    }
}
