//! State of the model-based pulses between two samples.

use crate::pulses::adaptation::{Adaptation, Lag};
use crate::pulses::leak::Leak;
use crate::pulses::run::Run;

/// State between two samples: the pulses under way, the adapted valves, the drift.
///
/// No array: its hash begins with a length in the width of the machine, and the digests of host and image would differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseState {
    pub(super) run: Run,
    pub(super) fill: Adaptation,
    pub(super) vent: Adaptation,
    pub(super) leak: Leak,
    pub(super) lag: Lag,
}

impl PulseState {
    /// Returns the state after switching the truck on: both valves shut, nominal valves, no leak.
    pub const fn at_rest() -> Self {
        Self {
            run: Run::SHUT,
            fill: Adaptation::NOMINAL,
            vent: Adaptation::NOMINAL,
            leak: Leak::NONE,
            lag: Lag::NONE,
        }
    }

    /// Returns the state for a takeover: no pulse is under way, what was learnt about the valves stays.
    #[must_use]
    pub const fn taking_over(self) -> Self {
        Self {
            run: Run::SHUT,
            ..self
        }
    }

    /// Notes that the coils did not get the last output. Its run ends, and nothing is learnt from it.
    pub const fn interrupt(&mut self) {
        self.run.interrupt();
    }
}
