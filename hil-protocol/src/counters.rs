//! What a link did to the frames.

use serde::{Deserialize, Serialize};

/// What one side of a link has seen; each stays at its largest number once it got there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkCounters {
    /// Frames that arrived undamaged and were due.
    pub accepted: u32,
    /// Frames whose framing or checksum is wrong, or that are longer than a frame can be.
    pub corrupt: u32,
    /// Undamaged frames whose message is not known.
    pub unknown: u32,
    /// Frames of the own direction: somebody sends them back.
    pub echoed: u32,
    /// Frames that came once more: the last request, answered again, or an answer that was there already.
    pub duplicate: u32,
    /// Frames that came late: older than the last one.
    pub stale: u32,
    /// Frames of another session.
    pub foreign: u32,
    /// Requests that came although one before them is missing.
    pub skipped: u32,
    /// Requests that were sent again because no answer came.
    pub repeated: u32,
}
