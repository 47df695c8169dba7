//! What a wire between plant and controller could carry, once per sample in each direction.
//!
//! Integers only: an emulator or a board answers with the same words as the controller in process, or it is a finding.

use crate::sensor::SensorCode;

/// To the controller: what it measures and what it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sensors {
    /// Number of the sample, from 0; an answer that is late or lost is seen by it.
    pub sample: u32,
    /// What the chamber is to reach.
    pub reference: ReferenceCode,
    /// What the pressure sensor shows.
    pub pressure: SensorCode,
}

/// To the plant: what the valves get until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Actuators {
    /// Fill valve.
    pub duty_fill: DutyCode,
    /// Vent valve.
    pub duty_vent: DutyCode,
}

impl Actuators {
    /// Both valves off.
    pub const OFF: Self = Self {
        duty_fill: DutyCode::OFF,
        duty_vent: DutyCode::OFF,
    };
}

/// Reference [bar gauge], -32768 ..< 32768, 2⁻¹⁶ bar — to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ReferenceCode(i32);

impl ReferenceCode {
    /// The code nearest to `bar`; the ends of the range for what is beyond, 0 for NaN.
    pub fn nearest(bar: f64) -> Self {
        // The conversion saturates by definition of `as`.
        Self((bar * 65536.0).round() as i32)
    }

    /// In bar gauge, exactly.
    pub fn bar(self) -> f64 {
        f64::from(self.0) / 65536.0
    }

    /// In units of 2⁻¹⁶ bar.
    pub const fn bits(self) -> i32 {
        self.0
    }
}

/// Duty cycle \[%\], 0 ..= 100, 2⁻¹⁶ % — to the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DutyCode(u32);

impl DutyCode {
    /// Never on.
    pub const OFF: Self = Self(0);
    /// Always on.
    pub const FULL: Self = Self(100 << 16);

    /// From units of 2⁻¹⁶ %; none beyond 100 %.
    pub const fn from_bits(bits: u32) -> Option<Self> {
        if bits > Self::FULL.0 {
            None
        } else {
            Some(Self(bits))
        }
    }

    /// In units of 2⁻¹⁶ %.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// In percent, exactly.
    pub fn percent(self) -> f64 {
        f64::from(self.0) / 65536.0
    }

    /// Whether the valve is never on.
    pub const fn is_off(self) -> bool {
        self.0 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duty_code_ends_exactly_at_100_percent() {
        assert_eq!(DutyCode::from_bits(6_553_600).unwrap().percent(), 100.0);
        assert_eq!(DutyCode::from_bits(6_553_601), None);
        assert_eq!(DutyCode::from_bits(0).unwrap(), DutyCode::OFF);
    }

    #[test]
    fn a_reference_is_off_by_at_most_half_a_unit() {
        for bar in [0.0, 0.1, -0.3, 5.964, 8.4] {
            let error = (ReferenceCode::nearest(bar).bar() - bar).abs();
            assert!(error <= 0.5 / 65536.0, "{bar}: {error}");
        }
    }
}
