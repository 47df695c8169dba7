//! Samples in a row.

/// One more sample in a row, up to 255, if it goes on; else none.
#[inline(always)]
pub(crate) const fn counted(samples: u8, goes_on: bool) -> u8 {
    if goes_on {
        samples.saturating_add(1)
    } else {
        0
    }
}
