//! From a sample that looks wrong to a fault.

/// Counts samples that look wrong up and the others down.
///
/// A fault is confirmed by N wrong samples in a row, or N more wrong than right ones, and is gone when the count is back at zero:
/// after N right ones in a row. What is wrong less than half of the time, such as noise, confirms nothing.
///
/// ```text
///  unconfirmed  0 ─ 1 ─ ... ─ N-1 ──► 2N   one byte: the count, and N more while confirmed
///    confirmed  0 ◄── N+1 ─ ... ─ 2N-1 ─ 2N
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Debounce(u8);

impl Debounce {
    pub(crate) const CLEAR: Self = Self(0);

    /// One sample; `limit` is N, 1 ..= 127 and the same in each sample.
    #[inline(always)]
    pub(crate) fn update(&mut self, looks_wrong: bool, limit: u8) {
        let limit = u32::from(limit);
        let end = limit.wrapping_mul(2);
        let count = u32::from(self.0);
        let moved = if looks_wrong {
            count.wrapping_add(1)
        } else {
            count.saturating_sub(1)
        };
        let jumped = if looks_wrong { end } else { 0 };
        let settled = if moved == limit { jumped } else { moved };
        self.0 = settled.min(end) as u8;
    }

    #[inline(always)]
    pub(crate) const fn is_confirmed(self, limit: u8) -> bool {
        self.0 > limit
    }
}

#[cfg(test)]
mod tests {
    use core::iter::repeat_n;

    use super::*;

    fn confirmed_after(samples: impl IntoIterator<Item = bool>, limit: u8) -> bool {
        let mut debounce = Debounce::CLEAR;
        for wrong in samples {
            debounce.update(wrong, limit);
        }
        debounce.is_confirmed(limit)
    }

    #[test]
    fn n_wrong_samples_confirm_and_one_less_does_not() {
        for limit in 1..=127 {
            let wrong = |samples| repeat_n(true, samples);
            let n = usize::from(limit);
            assert!(!confirmed_after(wrong(n - 1), limit), "{limit}");
            assert!(confirmed_after(wrong(n), limit), "{limit}");
            assert!(confirmed_after(wrong(n + 1), limit), "{limit}");
            assert!(confirmed_after(wrong(1000), limit), "{limit}");
        }
    }

    #[test]
    fn a_confirmed_fault_is_gone_after_n_right_samples_and_not_before() {
        for (right, expected) in [(2, true), (3, false), (4, false)] {
            let samples = repeat_n(true, 9).chain(repeat_n(false, right));
            assert_eq!(confirmed_after(samples, 3), expected, "{right}");
        }
    }

    #[test]
    fn a_confirmed_fault_that_wavers_stays() {
        let wavering = repeat_n(true, 5).chain([
            false, false, true, false, true, true, true, true, false, false,
        ]);
        assert!(confirmed_after(wavering, 3));
    }

    #[test]
    fn what_is_wrong_every_other_sample_confirms_nothing_and_two_of_three_do() {
        assert!(!confirmed_after((0..1000).map(|sample| sample % 2 == 0), 2));
        let two_of_three = |samples| (0..samples).map(|sample| sample % 3 != 0);
        assert!(!confirmed_after(two_of_three(5), 3));
        assert!(confirmed_after(two_of_three(6), 3));
    }
}
