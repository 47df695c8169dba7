//! Direction of the error. A sample is computed along this direction, so filling and venting are one case.

/// Direction of the error: `Up` asks for filling, `Down` for venting. An error of 0 counts as `Up`.
///
/// Along this direction the error is never negative, and a part of the control signal that works towards the reference
/// is positive. A sum can then reach only its upper end. The mirrored error gives the same numbers, and therefore
/// mirrored duty cycles.
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

    /// Converts a signed number into a number along this direction, or back. Not for the most negative number.
    #[inline(always)]
    pub(crate) const fn along(self, number: i32) -> i32 {
        match self {
            Self::Up => number,
            Self::Down => number.wrapping_neg(),
        }
    }
}
