//! Faults of the pressure sensor and its converter.

use super::{Survival, named};
use crate::campaign::bounds;

named! {
    /// Fault of the pressure sensor.
    SensorFault {
        /// The sensor shows the same value as at the beginning of the fault.
        Stuck = "stuck",
        /// Wire open, or short to ground: codes at the lower rail.
        Open = "open",
        /// Short to the supply: codes at the upper rail.
        Short = "short",
        /// Codes below the span and above the lower rail.
        BelowRange = "below-range",
        /// The pressure is above any supply; the severity is the height.
        AboveRange = "above-range",
        /// Noise; severity 1 is ten times the bench's.
        Noise = "noise",
        /// The sensor shows 1.7 to 4 bar too much or too little: more than a valve moves the pressure in a sample.
        Jump = "jump",
        /// The sensor shows any value within the supply, another one in each sample.
        Erratic = "erratic",
        /// The converter does not answer.
        Missing = "missing",
        /// The converter does not answer now and then; the severity is the frequency.
        Intermittent = "intermittent",
        /// The sensor drifts; severity 1: 1.5 bar/s, up to 3 bar.
        Drift = "drift",
        /// The sensor shows up to 1.5 bar too much or too little.
        Offset = "offset",
    }
}

/// Longest fault that is bridged with both valves shut (samples): HOLD_N less the recovery and the jump to the moved
/// pressure.
const BRIDGED: u32 = 30;

impl SensorFault {
    /// Returns whether the fault shows as an implausible pressure from the first to the last sample.
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
