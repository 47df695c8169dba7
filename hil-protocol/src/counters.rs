//! Frame counters of a link.

use serde::{Deserialize, Serialize};

/// Frame counters of one side of a link; each number saturates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkCounters {
    /// Frames that arrived undamaged and were due.
    pub accepted: u32,
    /// Frames with wrong framing or checksum, or longer than a frame can be.
    pub corrupt: u32,
    /// Undamaged frames with an unknown header or message.
    pub unknown: u32,
    /// Frames of the own direction, sent back by the wire.
    pub echoed: u32,
    /// Repeated frames: the last request, which is answered again, or an answer that was already received.
    pub duplicate: u32,
    /// Frames that came late, after newer ones.
    pub stale: u32,
    /// Frames of another session.
    pub foreign: u32,
    /// Requests that came although an earlier one is missing.
    pub skipped: u32,
    /// Requests that were sent again because no answer came: the frame of the request or of the answer was lost.
    pub repeated: u32,
}

impl LinkCounters {
    /// All counters zero.
    pub const ZERO: Self = Self {
        accepted: 0,
        corrupt: 0,
        unknown: 0,
        echoed: 0,
        duplicate: 0,
        stale: 0,
        foreign: 0,
        skipped: 0,
        repeated: 0,
    };
}

/// Increments a counter, saturating.
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}
