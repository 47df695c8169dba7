//! History of a condition over the last samples.

/// History of a condition in each of the last 32 samples, the newest in bit 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct History(u32);

impl History {
    /// Number of stored samples.
    pub(crate) const SAMPLES_MAX: u8 = 32;

    /// History after a reset: the past is unknown, so the condition counts as false.
    pub(crate) const UNKNOWN: Self = Self(0);

    /// Appends one sample.
    #[inline(always)]
    pub(crate) const fn push(&mut self, holds: bool) {
        self.0 = self.0 << 1 | holds as u32;
    }

    /// Returns whether the condition was true in each sample of `window`.
    #[inline(always)]
    pub(crate) const fn held_through(self, window: Window) -> bool {
        window.0 & !self.0 == 0
    }
}

/// Last N samples, as N ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Window(u32);

impl Window {
    /// Creates a window of the last `samples`, 1 ..= [`History::SAMPLES_MAX`].
    pub(crate) const fn last(samples: u8) -> Self {
        // The shift is 0 ..= 31.
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
