//! The contract between the image and the machine it runs on.

use core::fmt;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// The image did all that it was asked to do.
    Passed,
    /// It could not: it panicked, faulted or found nobody to report to.
    Failed,
}

/// What the image asks of a machine.
///
/// A board file holds facts only (addresses, pins, the way out to the person who watches); what to do with them is
/// decided above this trait, where the host's tests see it.
pub(crate) trait Board {
    /// The safe state: both coils without current, whatever ran before.
    ///
    /// Must work at any moment, also from the panic and the fault handler, must not wait and cannot fail. Calling it
    /// again changes nothing. It is the state at reset, and the state in which every run ends.
    fn coils_off(&mut self);

    /// Shows one line to whoever watches.
    ///
    /// # Errors
    /// `fmt::Error` if the line did not get out: nobody watches, or the channel is closed.
    fn show(&mut self, line: fmt::Arguments<'_>) -> fmt::Result;

    /// Ends the run with its verdict. The caller has switched the coils off.
    fn end(&mut self, verdict: Verdict) -> !;
}
