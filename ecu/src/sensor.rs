//! Pressure sensor and ADC, and the curve by which the controller's side reads the code.
//!
//! The sensor measures 0.06 to 2.1 MPa absolute (section 2.4.4). Its electrical side is assumed, as nothing is printed about
//! it: ratiometric, 0.5 V to 4.5 V of a 5 V supply. The bench logs show a pressure in steps of 5.1 mbar, which is
//! 20.4 bar / 4000: one step per millivolt. Twelve bits over 5 V would step by 6.2 mbar, so the ECU's input stage is
//! taken to put the sensor's span onto codes 48 to 4048 of 4095. A broken or shorted wire is then beyond the span, at code 0 or 4095.

use controller::Pressure;

/// Code of the 12-bit ADC, 0 ..= 4095 — to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorCode(u16);

impl SensorCode {
    /// Lowest code: a short to ground.
    pub const MIN: Self = Self(0);
    /// Highest code: a short to the supply.
    pub const MAX: Self = Self(4095);

    /// From the ADC's register; none beyond 12 bits.
    pub const fn from_bits(bits: u16) -> Option<Self> {
        if bits > Self::MAX.0 {
            None
        } else {
            Some(Self(bits))
        }
    }

    /// The ADC's register.
    pub const fn bits(self) -> u16 {
        self.0
    }
}

/// The transfer curve of the pressure sensor with its ADC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PressureSensor;

impl PressureSensor {
    /// Lowest measured pressure [Pa abs] (section 2.4.4).
    pub const LOWEST_PA: i64 = 60_000;
    /// Highest measured pressure [Pa abs] (section 2.4.4).
    pub const HIGHEST_PA: i64 = 2_100_000;
    /// Code at the lowest pressure (assumed).
    pub const CODE_AT_LOWEST: i64 = 48;
    /// Code at the highest pressure (assumed).
    pub const CODE_AT_HIGHEST: i64 = 4048;
    /// Pressure per code \[Pa\]: 5.1 mbar.
    pub const STEP_PA: i64 =
        (Self::HIGHEST_PA - Self::LOWEST_PA) / (Self::CODE_AT_HIGHEST - Self::CODE_AT_LOWEST);
    /// Ambient pressure [Pa abs] that the ECU subtracts to have a relative pressure (section 2.4.4 says 1 bar; the standard
    /// atmosphere, as the plant's ambient pressure is).
    pub const AMBIENT_PA: i64 = 101_325;

    /// What the controller takes a code for [bar gauge]: the transfer curve backwards, in integers, nearest 2⁻¹⁶ bar.
    #[inline]
    pub const fn pressure(code: SensorCode) -> Pressure {
        // Below 2³²; a division by a constant is a multiplication, and its floor with the half makes this the nearest.
        let steps = (code.0 as u32).wrapping_mul(STEP).wrapping_add(FIRST);
        Pressure::from_bits((steps / DENOMINATOR).cast_signed().wrapping_add(OFFSET))
    }
}

/// All pressures of the curve are multiples of this \[Pa\], which makes the divisor short.
const UNIT_PA: i64 = 5;
/// 2¹⁶ per bar over the units in a bar, in lowest terms.
const NUMERATOR: i64 = 2048;
const DENOMINATOR: u32 = 625;

/// Pressure per code [2⁻¹⁶ bar / `DENOMINATOR`].
const STEP: u32 = (PressureSensor::STEP_PA / UNIT_PA * NUMERATOR) as u32;

/// Pressure at code 0 [2⁻¹⁶ bar gauge / `DENOMINATOR`].
const AT_ZERO: i64 = (PressureSensor::LOWEST_PA
    - PressureSensor::CODE_AT_LOWEST * PressureSensor::STEP_PA
    - PressureSensor::AMBIENT_PA)
    / UNIT_PA
    * NUMERATOR;

/// Whole units of the pressure at code 0, rounded down ...
const OFFSET: i32 = AT_ZERO.div_euclid(DENOMINATOR as i64) as i32;

/// ... and the rest of it with the half that makes a floor the nearest.
const FIRST: u32 = AT_ZERO.rem_euclid(DENOMINATOR as i64) as u32 + DENOMINATOR / 2;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_the_5_1_mbar_of_the_bench_logs() {
        assert_eq!(PressureSensor::STEP_PA, 510);
        assert_eq!(
            PressureSensor::STEP_PA * 4000,
            PressureSensor::HIGHEST_PA - PressureSensor::LOWEST_PA
        );
    }

    /// All codes against the exact rational curve, rounded half up.
    #[test]
    fn the_integer_curve_is_the_nearest_to_the_real_one_at_every_code() {
        for bits in 0..=4095 {
            let code = SensorCode::from_bits(bits).unwrap();
            let gauge_pa = 60_000 + 510 * (i64::from(bits) - 48) - 101_325;
            let nearest = ((gauge_pa << 16) + 50_000).div_euclid(100_000);
            assert_eq!(
                i64::from(PressureSensor::pressure(code).to_bits()),
                nearest,
                "code {bits}"
            );
        }
        assert_eq!(SensorCode::from_bits(4096), None);
    }
}
