//! The few operations that a sample is made of, each with the reason why it cannot overflow (docs/numerics.md).

use core::sync::atomic::{Ordering, compiler_fence};

/// The exact product of two words: |a·b| ≤ 2⁶² whatever they are.
#[inline(always)]
pub(crate) const fn wide_product(a: i32, b: i32) -> i64 {
    (a as i64).wrapping_mul(b as i64)
}

/// The upper word, rounded towards -∞.
#[inline(always)]
pub(crate) const fn high_word(x: i64) -> i32 {
    (x >> 32) as i32
}

/// The upper word of the product, rounded towards -∞; one SMMUL.
#[inline(always)]
pub(crate) const fn high_product(a: i32, b: i32) -> i32 {
    high_word(wide_product(a, b))
}

/// A word as the upper half of a double word.
#[inline(always)]
pub(crate) const fn from_high_word(high: i32) -> i64 {
    (high as i64) << 32
}

/// Held within ±`bound`, which is not negative.
#[inline(always)]
pub(crate) fn held(x: i64, bound: i64) -> i64 {
    x.min(bound).max(bound.wrapping_neg())
}

/// From here on the compiler reads memory again, and not ahead of it. No instruction: but what is read early waits in a register,
/// and a sample has to save each one that it uses beyond the first few.
#[inline(always)]
pub(crate) fn no_reading_ahead() {
    compiler_fence(Ordering::SeqCst);
}
