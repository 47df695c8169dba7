//! Value that approaches its final value while the rig warms up.

/// Slow approach, counted from the beginning of a log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WarmUp {
    /// Final value.
    pub(crate) in_the_end: f64,
    /// Time constant (s).
    pub(crate) time_constant: f64,
}

impl WarmUp {
    /// Returns the value after `elapsed` (s).
    pub(crate) fn after(&self, elapsed: f64) -> f64 {
        -self.in_the_end * (-elapsed / self.time_constant).exp_m1()
    }
}
