//! Which way the reference lies. A sample is computed along this direction, so filling and venting are one case.

/// The direction of the error: up asks for filling, down for venting. An error of 0 counts as up.
///
/// Along it the error is never negative, a part of the control signal that works towards the reference is positive, and only
/// the upper end of a sum can be reached. The mirrored error gives the same numbers, and so mirrored duty cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Up,
    Down,
}

impl Direction {
    #[inline(always)]
    pub(crate) const fn of(signed: i32) -> Self {
        if signed < 0 { Self::Down } else { Self::Up }
    }

    /// A signed number along this direction; or a number along it, signed again. Not for the most negative number.
    #[inline(always)]
    pub(crate) const fn along(self, number: i32) -> i32 {
        match self {
            Self::Up => number,
            Self::Down => number.wrapping_neg(),
        }
    }
}
