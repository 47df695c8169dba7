//! Fault reactions that lead to the safe state.

use crate::campaign::bounds;

/// Fault reaction (`docs/safety.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaultReaction {
    /// Both valves shut, then release of the chamber in pulses.
    Hold,
    /// Ramp down, then venting.
    Ramp,
    /// Release of the chamber in pulses.
    Release,
    /// Venting at once.
    Vent,
    /// Both coils off at once.
    Off,
    /// Both coils off until a reset.
    Lock,
}

impl FaultReaction {
    /// Returns the maximum time from the answer to both coils off (samples).
    pub(super) const fn samples(self) -> u32 {
        let changes = bounds::CHANGES;
        match self {
            Self::Hold => bounds::HOLD_SAMPLES + bounds::RELEASE_SAMPLES + changes,
            Self::Ramp => bounds::RAMP_SAMPLES + changes,
            Self::Release => bounds::RELEASE_SAMPLES + changes,
            Self::Vent => bounds::VENT_SAMPLES + changes,
            Self::Off | Self::Lock => 0,
        }
    }

    pub(super) const fn empties(self) -> bool {
        !matches!(self, Self::Off | Self::Lock)
    }
}
