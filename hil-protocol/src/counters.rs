//! What a link did to the frames.

use serde::{Deserialize, Serialize};

/// What one side of a link has seen; each number stays at its largest once it got there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkCounters {
    /// Frames that arrived undamaged and were due.
    pub accepted: u32,
    /// Frames whose framing or checksum is wrong, or that are longer than a frame can be.
    pub corrupt: u32,
    /// Undamaged frames whose header or message is not known.
    pub unknown: u32,
    /// Frames of the own direction: somebody sends them back.
    pub echoed: u32,
    /// Frames that came once more: the last request, answered again, or an answer that was there already.
    pub duplicate: u32,
    /// Frames that came late, after newer ones.
    pub stale: u32,
    /// Frames of another session.
    pub foreign: u32,
    /// Requests that came although one before them is missing.
    pub skipped: u32,
    /// Requests that were sent again because no answer came: theirs or the answer's frame was lost.
    pub repeated: u32,
}

impl LinkCounters {
    /// Nothing seen.
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

/// One more.
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}
