//! Control signal: the output of the PID controller.

use core::fmt;

use fixed::types::I20F12;

/// Control signal u, -100 ..= 100 % after saturation, 2⁻²⁰ of 100 % (0.000 095 %) — between controller and distributor.
///
/// A positive u fills, a negative u vents (section 6.3). Before saturation u may be as large as ±98 000 %.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ControlSignal(i32);

impl ControlSignal {
    /// 0 %: neither valve is driven.
    pub const ZERO: Self = Self(0);
    /// 100 %: full filling.
    pub const MAX: Self = Self(1 << 20);
    /// -100 %: full venting.
    pub const MIN: Self = Self(-(1 << 20));

    /// Creates a control signal from percent, rounded to the nearest unit and saturated at ±100 %.
    #[must_use]
    pub fn saturating_from_percent(percent: I20F12) -> Self {
        const FULL_PCT: u32 = 100 << 12;
        let magnitude = u64::from(percent.to_bits().unsigned_abs().min(FULL_PCT));
        // 25 units of 2⁻¹² % equal 64 units of 2⁻²⁰ of 100 %.
        Self(signed((magnitude * 64 + 12) / 25, percent.to_bits()))
    }

    /// Returns the control signal in percent, rounded to the nearest 2⁻¹² %.
    pub const fn percent(self) -> I20F12 {
        // At most 2³¹ · 25, which fits into 64 bits.
        let magnitude = (self.0.unsigned_abs() as u64 * 25 + 32) / 64;
        I20F12::from_bits(signed(magnitude, self.0))
    }

    /// Returns the control signal in units of 2⁻¹² %, rounded to nearest; 100 % is 409 600.
    pub const fn to_bits(self) -> i32 {
        self.percent().to_bits()
    }

    /// Creates a control signal from units of 2⁻²⁰ of 100 %.
    #[inline(always)]
    pub(crate) const fn from_units(units: i32) -> Self {
        Self(units)
    }

    /// Returns the control signal in units of 2⁻²⁰ of 100 %.
    #[inline(always)]
    pub(crate) const fn units(self) -> i32 {
        self.0
    }

    /// Returns the control signal saturated at ±100 %.
    #[inline(always)]
    pub(crate) fn saturated(self) -> Self {
        self.max(Self::MIN).min(Self::MAX)
    }
}

/// Returns `magnitude` with the sign of `sign`.
const fn signed(magnitude: u64, sign: i32) -> i32 {
    (magnitude as i32).wrapping_mul(sign.signum())
}

impl fmt::Display for ControlSignal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.percent(), f)?;
        f.write_str(" %")
    }
}
