//! Debouncing: from wrong samples to a confirmed fault.

/// Counter that counts wrong samples up and right ones down.
///
/// A fault is confirmed by N wrong samples in a row, or by N more wrong than right ones. A condition that is wrong less
/// than half of the time, such as noise, confirms nothing. A confirmed fault is over after N right samples in a row.
///
/// ```text
///  unconfirmed   0 ⇄ 1 ⇄ ... ⇄ N-1 ──► -N    one byte, negative while confirmed
///    confirmed   0 ◄── -1 ◄─ ... ◄──── -N    any wrong sample: -N again
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Debounce(i8);

impl Debounce {
    pub(crate) const CLEAR: Self = Self(0);

    /// Takes one sample; `limit` is N, 1 ..= 127 and the same in each sample.
    #[inline(always)]
    pub(crate) fn update(&mut self, looks_wrong: bool, limit: u8) {
        let count = self.0;
        self.0 = if !looks_wrong {
            count.wrapping_sub(count.signum())
        } else if count.cast_unsigned() < limit.wrapping_sub(1) {
            count.wrapping_add(1)
        } else {
            limit.cast_signed().wrapping_neg()
        };
    }

    #[inline(always)]
    pub(crate) const fn is_confirmed(self) -> bool {
        self.0 < 0
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
        debounce.is_confirmed()
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
    fn a_confirmed_fault_is_gone_after_n_right_samples_in_a_row_and_not_before() {
        for limit in 1..=127 {
            let n = usize::from(limit);
            for (right, expected) in [(n - 1, true), (n, false), (n + 1, false)] {
                let samples = repeat_n(true, n + 5).chain(repeat_n(false, right));
                assert_eq!(
                    confirmed_after(samples, limit),
                    expected,
                    "{limit}, {right}"
                );
            }
            let interrupted = repeat_n(true, n)
                .chain(repeat_n(false, n - 1))
                .chain([true])
                .chain(repeat_n(false, n - 1));
            assert!(confirmed_after(interrupted, limit), "{limit}");
        }
    }

    #[test]
    fn what_is_wrong_every_other_sample_confirms_nothing_and_two_of_three_do() {
        assert!(!confirmed_after((0..1000).map(|sample| sample % 2 == 0), 2));
        let two_of_three = |samples| (0..samples).map(|sample| sample % 3 != 0);
        assert!(!confirmed_after(two_of_three(5), 3));
        assert!(confirmed_after(two_of_three(6), 3));
    }
}
