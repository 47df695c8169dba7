//! Faults of the messages with the reference.

use super::{Survival, named};
use crate::campaign::bounds;

named! {
    /// Fault of the reference's messages.
    LinkFault {
        /// Messages are lost; the severity is their share.
        Lost = "lost",
        /// The host sends nothing.
        Silent = "silent",
        /// References are impossible: far below vacuum, far above any supply.
        Corrupt = "corrupt",
        /// Every other message repeats the previous one.
        Duplicate = "duplicate",
        /// Each pair of messages comes in the wrong order.
        Reordered = "reordered",
        /// Messages come 1 to 20 samples late.
        Late = "late",
    }
}

impl LinkFault {
    pub(in crate::campaign) fn survival(self, duration: u32) -> Survival {
        match self {
            Self::Duplicate | Self::Reordered | Self::Late => Survival::Unnoticed,
            Self::Lost | Self::Silent | Self::Corrupt if duration < bounds::REFERENCE_N => {
                Survival::Unnoticed
            }
            Self::Lost | Self::Silent | Self::Corrupt => Survival::NotClaimed,
        }
    }
}
