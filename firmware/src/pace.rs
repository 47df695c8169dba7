//! Source of the pace of the samples.

/// Source of the pace of the control task; it determines the timeout of the watchdog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Pace {
    /// Sample timer: the watchdog resets after three samples without one.
    Timer,
    /// Host, which may pause: the watchdog only checks that the image runs.
    Host,
}
