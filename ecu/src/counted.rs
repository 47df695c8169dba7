//! Counter of consecutive samples.

/// Returns the number of consecutive samples, up to 255: one more if `goes_on`, otherwise 0.
#[inline(always)]
pub(crate) const fn counted(samples: u8, goes_on: bool) -> u8 {
    if goes_on {
        samples.saturating_add(1)
    } else {
        0
    }
}
