//! Pressure reading of a chamber that was emptied.

use super::rig::Rig;
use crate::campaign::bounds;
use crate::campaign::oracle::Observation;
use crate::campaign::oracle::memory::Memory;

/// Pressure for N samples with the vent valve open and the fill valve shut.
#[derive(Debug, Default)]
pub(super) struct Offset {
    /// Number of samples in which the vented chamber has shown a pressure; it decreases at the same rate.
    evidence: u32,
    is_present: bool,
}

impl Offset {
    pub(super) fn look(&mut self, rig: &Rig, observation: &Observation, memory: &Memory) -> bool {
        let is_vented =
            memory.is_open(1, rig.open_pct[1]) && memory.coil_settled(0, |duty| duty == 0.0);
        let is_shown = observation
            .shown_bar()
            .is_some_and(|shown| shown > bounds::EMPTY_BAR + 0.01);
        self.evidence = match (is_shown, is_vented) {
            (false, _) => 0,
            (true, true) => (self.evidence + 1).min(bounds::OFFSET_N),
            (true, false) if self.is_present => self.evidence.saturating_sub(1),
            (true, false) => 0,
        };
        // The condition ends a few samples before the fault is over for any ECU.
        let is_remembered = self.is_present && self.evidence > bounds::SETTLING;
        self.is_present = self.evidence >= bounds::OFFSET_N || is_remembered;
        self.is_present
    }
}
