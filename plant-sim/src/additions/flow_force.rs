//! The pressure force over the lift.

/// What an open valve loses of the pressure force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlowForce {
    /// Share that is lost at full lift (-).
    pub at_full_lift: f64,
    /// How much faster than in proportion to the lift the loss begins (-); 0 is in proportion.
    pub steepness: f64,
}

impl FlowForce {
    /// Share of the pressure force that is lost at `lift` (share of the stroke, 0 to 1), E58.
    pub(crate) fn lost_share(&self, lift: f64) -> f64 {
        self.at_full_lift * (1.0 + self.steepness) * lift / (1.0 + self.steepness * lift)
    }
}
