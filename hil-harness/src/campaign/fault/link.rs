//! What can happen to the messages that bring the reference.

use super::{Survival, named};
use crate::campaign::bounds;

named! {
    /// A fault of the reference's messages.
    LinkFault {
        /// Messages are lost; severity: how many.
        Lost = "lost",
        /// The host sends nothing.
        Silent = "silent",
        /// References that nobody can mean: far below vacuum, far above any supply.
        Corrupt = "corrupt",
        /// Every other message repeats the one before.
        Duplicate = "duplicate",
        /// Every two messages come in the wrong order.
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
