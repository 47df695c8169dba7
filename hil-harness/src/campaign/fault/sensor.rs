//! What can break in the pressure sensor and its converter.

use super::{Survival, named};
use crate::campaign::bounds;

named! {
    /// A fault of the pressure sensor.
    SensorFault {
        /// It shows what it showed when the fault began.
        Stuck = "stuck",
        /// Wire open, or short to ground: codes at the lower rail.
        Open = "open",
        /// Short to the supply: codes at the upper rail.
        Short = "short",
        /// Codes below the span and above the lower rail.
        BelowRange = "below-range",
        /// A pressure that no supply gives; severity: how high.
        AboveRange = "above-range",
        /// Noise; severity 1 is ten times the bench's.
        Noise = "noise",
        /// It shows 1.7 to 4 bar too much or too little: farther than a valve moves the pressure in a sample.
        Jump = "jump",
        /// It shows anything within the supply, another value in each sample.
        Erratic = "erratic",
        /// The converter does not answer.
        Missing = "missing",
        /// The converter does not answer now and then; severity: how often.
        Intermittent = "intermittent",
        /// It drifts away; severity 1: 1.5 bar/s, up to 3 bar.
        Drift = "drift",
        /// It shows up to 1.5 bar too much or too little.
        Offset = "offset",
    }
}

/// Duration that both valves shut bridge \[samples\]: HOLD_N less the recovery and the jump to where the pressure has moved.
const BRIDGED: u32 = 30;

impl SensorFault {
    /// Whether it shows as a pressure that cannot be believed, from the first to the last sample.
    pub(in crate::campaign) fn is_plain(self) -> bool {
        matches!(
            self,
            Self::Open | Self::Short | Self::BelowRange | Self::AboveRange | Self::Missing
        )
    }

    pub(in crate::campaign) fn survival(self, duration: u32) -> Survival {
        if self == Self::Noise || self.is_plain() && duration < bounds::DOUBT_N {
            Survival::Unnoticed
        } else if self.is_plain() && duration <= BRIDGED {
            Survival::Held
        } else {
            Survival::NotClaimed
        }
    }
}
