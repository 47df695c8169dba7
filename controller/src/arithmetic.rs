//! Arithmetic operations of a sample, each with the reason why it cannot overflow (docs/numerics.md).

use core::sync::atomic::{Ordering, compiler_fence};

/// Returns the exact product of two words: |a·b| ≤ 2⁶² for all words.
#[inline(always)]
pub(crate) const fn wide_product(a: i32, b: i32) -> i64 {
    (a as i64).wrapping_mul(b as i64)
}

/// Returns the upper word, rounded towards -∞.
#[inline(always)]
pub(crate) const fn high_word(x: i64) -> i32 {
    (x >> 32) as i32
}

/// Returns the upper word of the product, rounded towards -∞; one SMMUL.
#[inline(always)]
pub(crate) const fn high_product(a: i32, b: i32) -> i32 {
    high_word(wide_product(a, b))
}

/// Returns a double word with the given upper word and a lower word of 0.
#[inline(always)]
pub(crate) const fn from_high_word(high: i32) -> i64 {
    (high as i64) << 32
}

/// Clamps `x` to ±`bound`, which is not negative.
#[inline(always)]
pub(crate) fn clamp(x: i64, bound: i64) -> i64 {
    x.min(bound).max(bound.wrapping_neg())
}

/// Reload barrier: keeps the compiler from moving later memory reads before this point. It emits no instruction. A
/// value that is read early occupies a register, and a sample has to save each register beyond the first few.
#[inline(always)]
pub(crate) fn reload_barrier() {
    compiler_fence(Ordering::SeqCst);
}
