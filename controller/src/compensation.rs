//! Compensation of the duty limits for supply voltage and coil resistance.
//!
//! The force of a solenoid at a given gap depends on the coil current only (equation 3.10), and the mean current of a
//! coil with duty cycle D is D U/R. The current that opens, keeps open or just does not over-magnetise a valve is
//! therefore the same at each voltage U and resistance R if each duty limit is multiplied by U₀/U · R/R₀. Both duty
//! cycles are linear in the limits, so the product is taken once, of the duty cycle. This leaves the sample of the
//! controller as it is.
//!
//! A normally open vent valve opens where the current of its coil, which decays with τ = L/R, falls below the one that
//! holds it shut. A current that is k times lower reaches this level τ ln k sooner, so that its duty cycle is not
//! multiplied but shifted (docs/equations.md).

use crate::duty::Duty;
use crate::error::ConfigError;
use crate::input_output::Output;
use crate::range::{checked, propagate};
use crate::settings::Settings;
use crate::table::Field;

/// Factor of the duty limits, 2⁻¹⁶, 0 ..= 16.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DutyScale(u32);

impl DutyScale {
    /// Factor 1: the duty limits as they are set.
    pub const ONE: Self = Self(1 << 16);
    const MAX: u32 = 16 << 16;

    /// Creates a factor from units of 2⁻¹⁶, at most 16.
    pub const fn saturating_from_bits(bits: u32) -> Self {
        if bits > Self::MAX {
            Self(Self::MAX)
        } else {
            Self(bits)
        }
    }

    /// Returns the factor in units of 2⁻¹⁶.
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// Returns the product of a duty limit (%, 2⁻¹⁶, 0 ..= 100 %) with the factor. It may be above 100 %: then no duty
    /// cycle reaches the limit.
    #[inline(always)]
    pub const fn limit(self, limit: i32) -> i32 {
        // At most 2²³ · 2²⁰, which the shift reduces to 2²⁷.
        ((limit.unsigned_abs() as u64).wrapping_mul(self.0 as u64) >> 16) as i32
    }

    /// Returns the duty cycle multiplied by the factor, at most 100 %.
    #[inline(always)]
    pub fn duty(self, duty: Duty) -> Duty {
        Duty::saturating_from_bits(self.limit(duty.to_bits()))
    }

    /// Returns the logarithm to base two, 2⁻¹⁶, to 0.001; that of the least factor for 0.
    #[inline(always)]
    fn log2(self) -> i32 {
        let bits = self.0.max(1);
        let zeros = bits.leading_zeros();
        // The leading one is the highest bit; four bits behind it choose the cell, sixteen the place within it.
        let mantissa = bits << zeros;
        let cell = (mantissa >> 27) as usize & 15;
        let within = mantissa >> 11 & 0xFFFF;
        let (low, high) = (LOG2[cell], LOG2[cell + 1]);
        let fraction = low.wrapping_add(high.wrapping_sub(low).wrapping_mul(within) >> 16);
        let exponent = 15_i32.wrapping_sub(zeros as i32);
        (exponent << 16).wrapping_add(fraction as i32)
    }
}

/// log₂(1 + n/16), 2⁻¹⁶.
const LOG2: [u32; 17] = [
    0, 5_732, 11_136, 16_248, 21_098, 25_711, 30_109, 34_312, 38_336, 42_196, 45_904, 49_472,
    52_911, 56_229, 59_434, 62_534, 65_536,
];

/// Shift of the duty cycles of a valve that a current shuts: the share of time without current becomes this much shorter (%,
/// 2⁻¹⁶).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReleaseShift(i32);

impl ReleaseShift {
    /// No shift: the duty limits as they are set.
    pub const NONE: Self = Self(0);

    /// Returns a duty limit (%, 2⁻¹⁶, 0 ..= 100 %), shifted. It may be above 100 %: then no duty cycle reaches the limit.
    #[inline(always)]
    pub const fn limit(self, limit: i32) -> i32 {
        limit.wrapping_sub(self.0)
    }

    /// Returns the shifted duty cycle. A shut valve stays shut.
    #[inline(always)]
    pub fn duty(self, duty: Duty) -> Duty {
        if duty.is_off() {
            return Duty::OFF;
        }
        Duty::saturating_from_bits(self.limit(duty.to_bits()))
    }
}

impl Output {
    /// Returns both duty cycles as with duty limits that are multiplied by these factors.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, fill: DutyScale, vent: DutyScale) -> Self {
        Self {
            duty_fill: fill.duty(self.duty_fill),
            duty_vent: vent.duty(self.duty_vent),
        }
    }
}

/// Coefficients of the compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupplyCompensation {
    nominal_mv: u32,
    /// R₀ (ohm), 2⁻¹⁶.
    nominal_resistance: u32,
    /// A quarter of 1/U₀ (1/mV), 2⁻³².
    gain: u32,
    /// Shift of the duty cycles of a normally open vent valve for a factor of two (%), 2⁻¹⁶.
    release_per_octave: i32,
}

/// Natural logarithm of two, 2⁻¹⁶.
const LN_2: i64 = 45_426;

/// Lowest and highest supply voltage that the duty limits follow (mV): below, no coil of a 24 V valve opens it; above, a
/// load dump ends.
const FOLLOWED_MV: [u16; 2] = [9_000, 60_000];
/// Lowest plausible supply voltage (mV): an ECU for 24 V does not run below it.
const PLAUSIBLE_MIN_MV: u16 = 6_000;
/// Forward voltage of the freewheeling diode (mV): a silicon diode at some 0.2 A (assumed).
const DIODE_MV: i64 = 800;
/// Lowest and highest ratio R/R₀, 2⁻¹⁶: copper from -60 to 180 °C, and a twentieth of scatter.
const RATIO: [u32; 2] = [42_598, 111_411];
/// Lowest duty cycle whose mean current gives the resistance: 40 %, 2⁻¹⁶. Below, the current may decay to zero within
/// the period, and the diode does not conduct to its end.
const MEASURED_DUTY_MIN: i32 = 40 << 16;

/// Number of bits of a voltage (mV) between two points of the table of reciprocals.
const CELL_BITS: u32 = 9;
const CELLS: usize = 1 << (16 - CELL_BITS);
/// 2²⁹ over the voltage (mV) of each point, at most `u16::MAX`. Linear interpolation between points errs by less than
/// 0.1 % from 9 V on.
const RECIPROCALS: [u16; CELLS + 1] = {
    let mut table = [u16::MAX; CELLS + 1];
    let mut point = FOLLOWED_MV[0] as usize >> CELL_BITS;
    while point <= CELLS {
        table[point] = ((1_u32 << 29) / ((point as u32) << CELL_BITS)) as u16;
        point += 1;
    }
    table
};

impl SupplyCompensation {
    /// Returns the coefficients; `None` if the compensation is off.
    pub(crate) const fn new(settings: &Settings) -> Result<Option<Self>, ConfigError> {
        let Some(compensation) = settings.compensation else {
            return Ok(None);
        };
        let voltage = propagate!(checked(
            Field::NominalVoltage,
            compensation.nominal_voltage_v
        ));
        let resistance = propagate!(checked(
            Field::NominalResistance,
            compensation.nominal_resistance_ohm
        ));
        let shift = propagate!(checked(Field::ReleaseShift, compensation.release_shift_pct));
        let nominal_mv = ((voltage as i64).wrapping_mul(1000) >> 16) as u32;
        // The voltage is at least 9 V, so the lowest bit, which keeps the divisor from zero, changes nothing. The division
        // is one of the configuration, not of a sample.
        let gain = (1_u32 << 30).wrapping_div(nominal_mv | 1);
        Ok(Some(Self {
            nominal_mv,
            nominal_resistance: resistance as u32,
            gain,
            release_per_octave: ((shift as i64).wrapping_mul(LN_2) >> 16) as i32,
        }))
    }

    /// Returns the shift of a normally open vent valve with this factor of the duty limits.
    #[inline(always)]
    pub fn release_shift(&self, scale: DutyScale) -> ReleaseShift {
        // At most 2²³ · 2²¹, which the shift reduces to 2²⁸.
        let shift = i64::from(self.release_per_octave).wrapping_mul(scale.log2().into()) >> 16;
        ReleaseShift(shift as i32)
    }

    /// Returns the factor of the duty limits at this supply voltage (mV) and ratio of the resistance.
    ///
    /// A voltage that is not measured or not plausible (below 6 V, above 60 V) counts as the nominal one. From 6 to 9 V
    /// it counts as 9 V.
    #[inline(always)]
    pub fn scale(&self, supply_mv: Option<u16>, resistance: ResistanceRatio) -> DutyScale {
        let by_voltage = match plausible(supply_mv) {
            // At most 36 000 · 2¹⁶, which fits into 32 bits.
            Some(supply_mv) => self.nominal_mv.wrapping_mul(reciprocal(supply_mv)) >> 13,
            None => 1 << 16,
        };
        let product = (by_voltage as u64).wrapping_mul(resistance.0 as u64) >> 16;
        DutyScale::saturating_from_bits(product as u32)
    }

    /// Returns the ratio R/R₀ after the mean current of one PWM period with a constant duty cycle: the old one, moved
    /// towards the measured one by a low-pass filter. The gain is a quarter of the coil's mean voltage over U₀, and four
    /// times that if `is_first`.
    ///
    /// The mean voltage of a coil is D U - (1 - D) U_diode, and R times its mean current in a steady state (flux
    /// balance over a period, docs/equations.md).
    #[inline(always)]
    pub fn measured(
        &self,
        old: ResistanceRatio,
        coil: &CoilMeasurement,
        is_first: bool,
    ) -> ResistanceRatio {
        let duty = i64::from(coil.duty.to_bits());
        let rest = i64::from(coil.duty.complement().to_bits());
        let driven = duty
            .wrapping_mul(coil.supply_mv.into())
            .wrapping_sub(rest.wrapping_mul(DIODE_MV));
        // 2⁻¹⁶ % times mV in mV: a hundredth is 167 772 · 2⁻²⁴.
        let voltage_mv = (driven >> 16).wrapping_mul(167_772) >> 24;
        let nominal_mv =
            i64::from(coil.current_ma).wrapping_mul(self.nominal_resistance.into()) >> 16;
        let expected_mv = nominal_mv.wrapping_mul(old.0.into()) >> 16;
        let error_mv = voltage_mv.wrapping_sub(expected_mv);
        // At most 2²⁷ · 2¹⁷.
        let shift = if is_first { 14 } else { 16 };
        let step = error_mv.wrapping_mul(self.gain.into()) >> shift;
        let [min, max] = RATIO;
        let ratio = i64::from(old.0).wrapping_add(step);
        ResistanceRatio(ratio.max(min.into()).min(max.into()) as u32)
    }
}

/// Ratio R/R₀ of a coil's resistance to that at which the duty limits were found, 2⁻¹⁶.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ResistanceRatio(u32);

impl ResistanceRatio {
    /// Ratio 1: the resistance at which the duty limits were found.
    pub const NOMINAL: Self = Self(1 << 16);

    /// Returns the ratio in units of 2⁻¹⁶.
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// Creates a ratio from units of 2⁻¹⁶.
    #[cfg(test)]
    pub(crate) const fn of_bits(bits: u32) -> Self {
        Self(bits)
    }
}

/// Measurement of a coil over one PWM period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CoilMeasurement {
    duty: Duty,
    supply_mv: u16,
    current_ma: u16,
}

impl CoilMeasurement {
    /// Creates a measurement; `None` if the resistance does not follow from it: duty cycle below 40 %, or voltage not
    /// plausible.
    #[inline(always)]
    pub fn new(duty: Duty, supply_mv: Option<u16>, current_ma: u16) -> Option<Self> {
        let supply_mv = plausible(supply_mv)?;
        (duty.to_bits() >= MEASURED_DUTY_MIN).then_some(Self {
            duty,
            supply_mv,
            current_ma,
        })
    }
}

/// Returns the voltage (mV) that the duty limits follow, if it is plausible.
#[inline(always)]
fn plausible(supply_mv: Option<u16>) -> Option<u16> {
    let [min, max] = FOLLOWED_MV;
    let supply_mv =
        supply_mv.filter(|&supply_mv| supply_mv >= PLAUSIBLE_MIN_MV && supply_mv <= max)?;
    Some(supply_mv.max(min))
}

/// Returns 2²⁹ over a voltage (mV).
#[inline(always)]
fn reciprocal(supply_mv: u16) -> u32 {
    let cell = usize::from(supply_mv >> CELL_BITS);
    let within = u32::from(supply_mv & ((1 << CELL_BITS) - 1));
    // No `map` over both: its loop has no proved number of instructions.
    let low = u32::from(RECIPROCALS[cell]);
    let high = u32::from(RECIPROCALS[cell + 1]);
    // The table falls, and the difference of two of its values times 2⁹ is below 2²⁵.
    low.wrapping_sub(low.wrapping_sub(high).wrapping_mul(within) >> CELL_BITS)
}

#[cfg(test)]
mod tests {
    use fixed::types::I16F16;

    use super::*;
    use crate::config::Config;
    use crate::input_output::Input;
    use crate::pressure::Pressure;
    use crate::settings::{Compensation, LowerLimit, OpeningDuty};
    use crate::state::State;
    use crate::step::step;

    fn nominal() -> SupplyCompensation {
        SupplyCompensation::new(&Settings::recommended())
            .unwrap()
            .unwrap()
    }

    /// Goal: the table replaces the division. Method: every voltage and the exact quotient.
    #[test]
    fn the_factor_of_the_voltage_is_its_quotient_to_a_thousandth() {
        for supply_mv in 9_000..=60_000_u16 {
            let found = nominal().scale(Some(supply_mv), ResistanceRatio::NOMINAL);
            let exact = 24_000.0 / f64::from(supply_mv);
            let error = f64::from(found.to_bits()) / 65_536.0 / exact - 1.0;
            assert!(error.abs() < 1e-3, "{supply_mv} mV: {error}");
        }
    }

    #[test]
    fn a_voltage_that_is_not_plausible_counts_as_nominal_and_a_low_one_as_nine_volts() {
        let scale = |supply_mv| nominal().scale(supply_mv, ResistanceRatio::NOMINAL);
        for supply_mv in [None, Some(0), Some(5_999), Some(60_001), Some(u16::MAX)] {
            assert_eq!(scale(supply_mv), DutyScale::ONE, "{supply_mv:?}");
        }
        assert_eq!(scale(Some(6_000)), scale(Some(9_000)));
        assert_ne!(scale(Some(9_000)), scale(Some(9_100)));
    }

    /// The product of the duty cycle is the duty cycle of multiplied limits, for both kinds of lower limit.
    #[test]
    fn a_scaled_duty_cycle_is_that_of_scaled_limits() {
        let times = |limit: I16F16| limit * I16F16::lit("0.75");
        let limits = |factor: I16F16| {
            let [fill, vent] = [I16F16::lit("54.5"), I16F16::lit("51.5")]
                .map(|pct| OpeningDuty::linear(factor * pct, factor * I16F16::lit("25.5")));
            LowerLimit::PressureDependent { fill, vent }
        };
        let plain = Settings {
            duty_min: limits(I16F16::ONE),
            ..Settings::recommended()
        };
        let scaled = Settings {
            duty_min: limits(I16F16::lit("0.75")),
            duty_max_fill_pct: times(plain.duty_max_fill_pct),
            duty_max_vent_pct: times(plain.duty_max_vent_pct),
            ..plain
        };
        let scale = DutyScale::saturating_from_bits(3 << 14);
        let [plain, scaled] = [plain, scaled].map(|settings| Config::new(&settings).unwrap());
        for reference in -2..80 {
            for pressure in 0..80 {
                let input = Input {
                    reference: Pressure::from_bits(reference << 13),
                    pressure: Pressure::from_bits(pressure << 13),
                };
                let found = step(&plain, &mut State::new(input), input).scaled(scale, scale);
                let expected = step(&scaled, &mut State::new(input), input);
                let differ = |a: Duty, b: Duty| (a.to_bits() - b.to_bits()).abs();
                // Rounding of the limits and of two products, in 2^-16 %.
                assert!(differ(found.duty_fill, expected.duty_fill) <= 4);
                assert!(differ(found.duty_vent, expected.duty_vent) <= 4);
            }
        }
    }

    #[test]
    fn a_limit_beyond_full_duty_is_never_reached_and_the_duty_cycle_saturates() {
        let scale = DutyScale::saturating_from_bits(3 << 15);
        let limit = 75 << 16;
        assert_eq!(scale.duty(Duty::saturating_from_bits(limit)), Duty::FULL);
        assert!(scale.limit(limit) > Duty::FULL.to_bits());
        assert_eq!(DutyScale::ONE.limit(limit), limit);
        let [most, beyond] = [16 << 16, u32::MAX].map(DutyScale::saturating_from_bits);
        assert_eq!(most, beyond);
        assert_eq!(scale.duty(Duty::OFF), Duty::OFF);
    }

    #[test]
    fn the_logarithm_of_a_factor_is_exact_to_a_thousandth() {
        let factors = (1..=2000).map(|n| DutyScale::saturating_from_bits(n * 521));
        for scale in factors.chain([DutyScale::ONE, DutyScale(DutyScale::MAX)]) {
            let exact = (f64::from(scale.to_bits()) / 65_536.0).log2();
            let error = f64::from(scale.log2()) / 65_536.0 - exact;
            assert!(error.abs() < 1e-3, "{scale:?}: {error}");
        }
        assert_eq!(DutyScale::ONE.log2(), 0);
        assert_eq!(DutyScale(0).log2(), DutyScale(1).log2());
    }

    /// If a coil needs e times the mean voltage, its time without current is shorter by `release_shift_pct` of the period.
    #[test]
    fn a_normally_open_valve_is_left_without_current_for_less_time_when_more_is_needed() {
        let shift = |factor: f64| {
            let bits = (factor * 65_536.0) as u32;
            nominal().release_shift(DutyScale::saturating_from_bits(bits))
        };
        let half = Duty::saturating_from_bits(50 << 16);
        for (factor, percent) in [
            (core::f64::consts::E, 8.5),
            (1.0, 50.0),
            (0.75, 61.94),
            (0.2, 100.0),
        ] {
            let found = f64::from(shift(factor).duty(half).to_bits()) / 65_536.0;
            assert!((found - percent).abs() < 0.05, "{factor}: {found}");
        }
        assert_eq!(shift(8.0).duty(half), Duty::OFF);
        // At a high voltage, no duty cycle certainly opens the valve.
        assert!(shift(0.5).limit(75 << 16) > Duty::FULL.to_bits());
        for factor in [0.5, 1.5] {
            assert_eq!(shift(factor).duty(Duty::OFF), Duty::OFF);
        }
    }

    #[test]
    fn the_ratio_settles_at_the_measured_resistance_and_stays_within_its_bounds() {
        let after = |resistance: f64, duty: i32, supply_mv: u16| {
            let duty = Duty::saturating_from_bits(duty << 16);
            let share = f64::from(duty.to_bits()) / 6_553_600.0;
            let mean_v = share * f64::from(supply_mv) * 1e-3 - (1.0 - share) * 0.8;
            let current_ma = (1e3 * mean_v / resistance).round() as u16;
            let coil = CoilMeasurement::new(duty, Some(supply_mv), current_ma).unwrap();
            (0..200).fold(ResistanceRatio::NOMINAL, |old, round| {
                nominal().measured(old, &coil, round < 4)
            })
        };
        for (ohm, duty, supply_mv) in [(63.0, 47, 32_000), (82.2, 82, 24_000), (114.3, 100, 18_000)]
        {
            let ratio = f64::from(after(ohm, duty, supply_mv).to_bits()) / 65_536.0;
            assert!((ratio / (ohm / 82.2) - 1.0).abs() < 0.01, "{ohm}: {ratio}");
        }
        let [min, max] = RATIO;
        assert_eq!(after(10.0, 100, 24_000).to_bits(), min);
        assert_eq!(after(1000.0, 100, 24_000).to_bits(), max);
    }

    #[test]
    fn the_resistance_does_not_follow_from_a_low_duty_cycle_or_an_unknown_voltage() {
        let duty = Duty::saturating_from_bits(MEASURED_DUTY_MIN);
        let less = Duty::saturating_from_bits(MEASURED_DUTY_MIN - 1);
        assert!(CoilMeasurement::new(duty, Some(24_000), 100).is_some());
        assert!(CoilMeasurement::new(less, Some(24_000), 100).is_none());
        assert!(CoilMeasurement::new(duty, None, 100).is_none());
        assert!(CoilMeasurement::new(duty, Some(0), 100).is_none());
    }

    #[test]
    fn the_thesis_controller_has_no_compensation() {
        let of = |settings: Settings| Config::new(&settings).unwrap().compensation().copied();
        assert_eq!(of(Settings::thesis()), None);
        assert_eq!(of(Settings::recommended()), Some(nominal()));
        assert_eq!(
            Settings::recommended().compensation,
            Some(Compensation {
                nominal_voltage_v: I16F16::lit("24"),
                nominal_resistance_ohm: I16F16::lit("82.2"),
                release_shift_pct: I16F16::lit("41.5"),
            })
        );
    }
}
