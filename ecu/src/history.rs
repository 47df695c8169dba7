//! The last samples of a condition.

/// Whether a condition held in each of the last 32 samples, the newest in bit 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct History(u32);

impl History {
    /// As many samples as it remembers.
    pub(crate) const SAMPLES_MAX: u8 = 32;

    /// After a reset nobody knows: it did not hold.
    pub(crate) const UNKNOWN: Self = Self(0);

    /// One more sample.
    #[inline(always)]
    pub(crate) const fn push(&mut self, holds: bool) {
        self.0 = self.0 << 1 | holds as u32;
    }

    /// Whether it held in each sample of `window`.
    #[inline(always)]
    pub(crate) const fn held_through(self, window: Window) -> bool {
        window.0 & !self.0 == 0
    }
}

/// The last N samples: N ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Window(u32);

impl Window {
    /// The last `samples`, 1 ..= [`History::SAMPLES_MAX`].
    pub(crate) const fn last(samples: u8) -> Self {
        // A shift by 0 ..= 31.
        Self(u32::MAX >> (History::SAMPLES_MAX.wrapping_sub(samples) & 31))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_held_through_n_samples_from_the_nth_on() {
        for n in 1..=History::SAMPLES_MAX {
            let mut history = History::UNKNOWN;
            history.push(true);
            history.push(false);
            for sample in 1..=40 {
                history.push(true);
                assert_eq!(
                    history.held_through(Window::last(n)),
                    sample >= n,
                    "{n}, {sample}"
                );
            }
            history.push(false);
            assert!(!history.held_through(Window::last(n)));
        }
    }
}
