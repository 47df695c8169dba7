//! The few operations that a sample is made of, each with the reason why it cannot overflow (docs/numerics.md).

/// The exact product of two words: |a·b| ≤ 2⁶² whatever they are.
#[inline(always)]
pub(crate) const fn wide_product(a: i32, b: i32) -> i64 {
    (a as i64).wrapping_mul(b as i64)
}

/// The upper word of the product, rounded towards -∞; one SMMUL.
#[inline(always)]
pub(crate) const fn high_product(a: i32, b: i32) -> i32 {
    (wide_product(a, b) >> 32) as i32
}

/// The upper word, rounded towards zero, so that -x gives exactly the negative of x.
#[inline(always)]
pub(crate) const fn high_word_towards_zero(x: i64) -> i32 {
    let high = (x >> 32) as i32;
    // One more where x is negative and its lower word is not zero: that is where all ones carry out of the lower word.
    let (_, carry) = (x as u32).overflowing_add((high >> 31) as u32);
    high.wrapping_add(carry as i32)
}

/// A word as the upper half of a double word.
#[inline(always)]
pub(crate) const fn from_high_word(high: i32) -> i64 {
    (high as i64) << 32
}

/// Whether exactly one of the two is negative.
#[inline(always)]
pub(crate) const fn differ_in_sign(a: i32, b: i32) -> bool {
    (a ^ b) < 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_towards_zero_is_division_and_mirrors() {
        for upper in [0, 1, 2, 409_600, i32::MAX >> 1] {
            for lower in [0, 1, 1 << 31, u32::MAX] {
                let x = from_high_word(upper) | i64::from(lower);
                assert_eq!(i64::from(high_word_towards_zero(x)), x / (1 << 32));
                assert_eq!(high_word_towards_zero(-x), -high_word_towards_zero(x));
            }
        }
    }

    #[test]
    fn zero_counts_as_positive() {
        assert!(
            !differ_in_sign(0, 0)
                && !differ_in_sign(0, 1)
                && differ_in_sign(0, -1)
                && differ_in_sign(1, -1)
        );
    }
}
