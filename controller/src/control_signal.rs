//! Control signal: what the PID asks for.

use core::fmt;

use fixed::types::I20F12;

/// Control signal u [%], -100 ..= 100 after saturation, 2⁻¹² % (0.00024 %) — between controller and distributor.
///
/// Positive fills, negative vents (section 6.3). Before saturation it may be far beyond: up to ±2¹⁹ %.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ControlSignal(I20F12);

impl ControlSignal {
    /// Neither valve is asked for.
    pub const ZERO: Self = Self(I20F12::ZERO);
    /// Fill at full.
    pub const MAX: Self = Self(I20F12::lit("100"));
    /// Vent at full.
    pub const MIN: Self = Self(I20F12::lit("-100"));

    /// From percent, held at ±100 %.
    #[must_use]
    pub fn saturating_from_percent(percent: I20F12) -> Self {
        Self(percent).saturated()
    }

    /// In percent.
    pub const fn percent(self) -> I20F12 {
        self.0
    }

    /// In units of 2⁻¹² %; 100 % is 409 600.
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }

    pub(crate) const fn from_bits(bits: i32) -> Self {
        Self(I20F12::from_bits(bits))
    }

    /// Held at ±100 %.
    #[must_use]
    #[inline]
    pub(crate) fn saturated(self) -> Self {
        self.max(Self::MIN).min(Self::MAX)
    }
}

impl fmt::Display for ControlSignal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)?;
        f.write_str(" %")
    }
}
