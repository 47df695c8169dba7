//! Pressure force over the lift.

/// Loss of pressure force of an open valve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlowForce {
    /// Share that is lost at full lift (-).
    pub at_full_lift: f64,
    /// Steepness of the loss near the seat (-); 0 is in proportion to the lift.
    pub steepness: f64,
}

impl FlowForce {
    /// Returns the share of the pressure force that is lost at `lift` (share of the stroke, 0 to 1), E58.
    #[inline]
    pub(crate) fn lost_share(&self, lift: f64) -> f64 {
        self.at_full_lift * (1.0 + self.steepness) * lift / (1.0 + self.steepness * lift)
    }
}
