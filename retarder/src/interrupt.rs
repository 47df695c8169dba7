//! Ctrl-C, SIGTERM and SIGHUP while an output file is under way.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Exit status of a process that a second signal ends at once.
const ENDED_BY_SIGNAL: i32 = 130;

/// Becomes true at such a signal, so that the file under way can be removed. A second one ends the process at once, for
/// what waits for input sees no flag.
pub(crate) fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            process::exit(ENDED_BY_SIGNAL);
        }
    })?;
    Ok(flag)
}
