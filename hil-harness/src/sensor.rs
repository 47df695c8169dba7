//! Pressure sensor and ADC, and the curve by which the controller's side reads the code.
//!
//! The sensor measures 0.06 to 2.1 MPa absolute (section 2.4.4). Its electrical side is assumed, as nothing is printed about
//! it: ratiometric, 0.5 V to 4.5 V of a 5 V supply. The bench logs show a pressure in steps of 5.1 mbar, which is
//! 20.4 bar / 4000: one step per millivolt. Twelve bits over 5 V would step by 6.2 mbar, so the ECU's input stage is
//! taken to put the sensor's span onto codes 48 to 4048 of 4095. A broken or shorted wire is then beyond the span, at code 0 or 4095.

use controller::Pressure;

/// Code of the 12-bit ADC, 0 ..= 4095 — to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
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

/// The pressure sensor with its ADC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

    /// The code at a pressure [Pa abs], nearest, held at the rails. A NaN reads as the lowest code.
    pub fn code(pressure_pa: f64) -> SensorCode {
        let steps = (pressure_pa - Self::LOWEST_PA as f64) / Self::STEP_PA as f64;
        let code = (steps + Self::CODE_AT_LOWEST as f64).round();
        // The conversion saturates by definition of `as`; 16 bits are then held at 12.
        SensorCode((code as u16).min(SensorCode::MAX.0))
    }

    /// What the controller takes a code for [bar gauge]: the transfer curve backwards, in integers, nearest 2⁻¹⁶ bar.
    pub const fn pressure(code: SensorCode) -> Pressure {
        let above_lowest = (code.0 as i64 - Self::CODE_AT_LOWEST) * Self::STEP_PA;
        let gauge_pa = Self::LOWEST_PA + above_lowest - Self::AMBIENT_PA;
        // At most 2.1 MPa · 2¹⁶: 38 bits. Half of the divisor and a floor make it the nearest.
        let bits = ((gauge_pa << 16) + PA_PER_BAR / 2).div_euclid(PA_PER_BAR);
        Pressure::from_bits(bits as i32)
    }
}

const PA_PER_BAR: i64 = 100_000;

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

    /// All codes against the curve in f64.
    #[test]
    fn the_integer_curve_is_the_nearest_to_the_real_one_at_every_code() {
        for bits in 0..=4095 {
            let code = SensorCode::from_bits(bits).unwrap();
            let exact_bar = (60_000.0 + 510.0 * (f64::from(bits) - 48.0) - 101_325.0) / 1e5;
            let found = f64::from(PressureSensor::pressure(code).to_bits()) / 65536.0;
            assert!(
                (found - exact_bar).abs() <= 0.5 / 65536.0,
                "code {bits}: {found} and {exact_bar} bar"
            );
        }
        assert_eq!(SensorCode::from_bits(4096), None);
    }

    #[test]
    fn a_pressure_comes_back_within_half_a_step_over_the_whole_range() {
        for step in 0..=20_400 {
            let pressure_pa = 60_000.0 + 100.0 * f64::from(step);
            let read = PressureSensor::pressure(PressureSensor::code(pressure_pa));
            let read_pa = f64::from(read.to_bits()) / 65536.0 * 1e5 + 101_325.0;
            assert!(
                (read_pa - pressure_pa).abs() <= 256.0,
                "{pressure_pa} Pa reads as {read_pa} Pa"
            );
        }
    }

    #[test]
    fn a_pressure_beyond_the_range_is_held_at_the_rails() {
        for (pressure_pa, expected) in [
            (0.0, SensorCode::MIN),
            (3e6, SensorCode::MAX),
            (f64::INFINITY, SensorCode::MAX),
            (f64::NAN, SensorCode::MIN),
        ] {
            assert_eq!(PressureSensor::code(pressure_pa), expected, "{pressure_pa}");
        }
    }
}
