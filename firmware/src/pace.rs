//! Who says when the next sample is.

/// What sets the pace of the control task, and so how soon the watchdog has to bite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Pace {
    /// The sample timer: the watchdog bites after three samples without one.
    Timer,
    /// The host, which may stop to think: the watchdog only sees that the image is alive.
    Host,
}
