//! Pressure sensor with ADC, and the conversion of its code into a pressure.
//!
//! The sensor measures 0.06 to 2.1 MPa absolute (section 2.4.4). Its electrical side is assumed, because the thesis
//! does not describe it: ratiometric, 0.5 V to 4.5 V of a 5 V supply. The bench logs show a pressure in steps of 5.1
//! mbar, which is 20.4 bar / 4000: one step per millivolt. Twelve bits over 5 V would give steps of 6.2 mbar. Therefore
//! the ECU's input stage is assumed to map the sensor's span to codes 48 to 4048 of 4095. A broken or shorted wire is
//! then beyond the span, at code 0 or 4095.

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

    /// Creates a code from the ADC's register; `None` beyond 12 bits.
    pub const fn from_bits(bits: u16) -> Option<Self> {
        if bits > Self::MAX.0 {
            None
        } else {
            Some(Self(bits))
        }
    }

    /// Returns the value of the ADC's register.
    pub const fn bits(self) -> u16 {
        self.0
    }
}

/// Transfer curve of the pressure sensor with its ADC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PressureSensor;

impl PressureSensor {
    /// Lowest measured pressure (Pa abs), section 2.4.4.
    pub const LOWEST_PA: i64 = 60_000;
    /// Highest measured pressure (Pa abs), section 2.4.4.
    pub const HIGHEST_PA: i64 = 2_100_000;
    /// Code at the lowest pressure (assumed).
    pub const CODE_AT_LOWEST: i64 = 48;
    /// Code at the highest pressure (assumed).
    pub const CODE_AT_HIGHEST: i64 = 4048;
    /// Pressure per code (Pa): 5.1 mbar.
    pub const STEP_PA: i64 =
        (Self::HIGHEST_PA - Self::LOWEST_PA) / (Self::CODE_AT_HIGHEST - Self::CODE_AT_LOWEST);
    /// Ambient pressure (Pa abs) that the ECU subtracts to get a gauge pressure. Section 2.4.4 says 1 bar; this is the
    /// standard atmosphere, like the plant's ambient pressure.
    pub const AMBIENT_PA: i64 = 101_325;

    /// Returns the pressure of a code (bar gauge): the inverse transfer curve, in integers, rounded to the nearest 2⁻¹⁶
    /// bar.
    #[inline]
    pub const fn pressure(code: SensorCode) -> Pressure {
        // Below 2³². A division by a constant is a multiplication; its floor with the added half gives the nearest
        // value.
        let steps = (code.0 as u32).wrapping_mul(STEP).wrapping_add(FIRST);
        Pressure::from_bits((steps / DENOMINATOR).cast_signed().wrapping_add(OFFSET))
    }
}

/// Common divisor of all pressures of the curve (Pa), which makes the divisor below short.
const UNIT_PA: i64 = 5;
/// 2¹⁶ per bar divided by the units in a bar, in lowest terms.
const NUMERATOR: i64 = 2048;
const DENOMINATOR: u32 = 625;

/// Pressure per code (2⁻¹⁶ bar / `DENOMINATOR`).
const STEP: u32 = (PressureSensor::STEP_PA / UNIT_PA * NUMERATOR) as u32;

/// Pressure at code 0 (2⁻¹⁶ bar gauge / `DENOMINATOR`).
const AT_ZERO: i64 = (PressureSensor::LOWEST_PA
    - PressureSensor::CODE_AT_LOWEST * PressureSensor::STEP_PA
    - PressureSensor::AMBIENT_PA)
    / UNIT_PA
    * NUMERATOR;

/// Integer part of the pressure at code 0 (2⁻¹⁶ bar), rounded down.
const OFFSET: i32 = AT_ZERO.div_euclid(DENOMINATOR as i64) as i32;

/// Remainder of the pressure at code 0, plus the half that turns a floor into rounding to nearest.
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

    /// Compares all codes with the exact rational curve, rounded half up.
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
