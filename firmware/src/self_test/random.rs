//! Random numbers that are the same on every machine.

/// Marsaglia's xorshift of 32 bits (Journal of Statistical Software 8 (14), 2003): shifts 13, 17, 5; period 2³² - 1.
pub(crate) struct Random(u32);

impl Random {
    /// Creates a generator from a seed other than zero; xorshift never leaves the state zero.
    pub(crate) const fn new(seed: core::num::NonZeroU32) -> Self {
        Self(seed.get())
    }

    /// Returns any value but zero.
    pub(crate) fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// Returns a value in `0..bound`; zero if `bound` is zero.
    pub(crate) fn below(&mut self, bound: u32) -> u32 {
        // The high half of the product: no division, and as uniform as the bits.
        ((u64::from(self.bits()) * u64::from(bound)) >> 32) as u32
    }

    /// Returns a value in `-size..=size`, for sizes below 2³⁰.
    pub(crate) fn around_zero(&mut self, size: u32) -> i32 {
        self.below(2 * size + 1) as i32 - size as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::num::NonZeroU32;

    #[test]
    fn the_first_numbers_from_seed_1_are_those_worked_out_by_hand() {
        let mut random = Random::new(NonZeroU32::MIN);
        // 1 -> ^ 1<<13 = 0x2001 -> ^ >>17 = 0x2001 -> ^ <<5 = 0x42021.
        assert_eq!(random.bits(), 0x0004_2021);
        assert_eq!(random.bits(), 0x0408_0601);
    }

    #[test]
    fn a_bounded_number_stays_below_its_bound_and_reaches_all_of_it() {
        let mut random = Random::new(NonZeroU32::MIN);
        let mut seen = [false; 7];
        for _ in 0..1000 {
            seen[random.below(7) as usize] = true;
        }
        assert_eq!(seen, [true; 7]);
        assert_eq!(random.below(0), 0);
    }

    #[test]
    fn noise_is_bounded_on_both_sides_and_reaches_both_bounds() {
        let mut random = Random::new(NonZeroU32::MIN);
        let noise: Vec<i32> = (0..1000).map(|_| random.around_zero(3)).collect();
        assert_eq!(
            (noise.iter().min(), noise.iter().max()),
            (Some(&-3), Some(&3))
        );
    }
}
