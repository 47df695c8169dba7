//! On-times and open times of a valve, over chamber pressure and slowness.
//!
//! The open time of a run of pulses is the integral of the valve's opening as a share of its bore. It depends on the
//! pressure, which helps or hinders the opening, and on the supply voltage, which sets how fast the current rises.

use crate::compensation::{DutyScale, ResistanceRatio};
use crate::pulses::config::PERIOD_US;

/// Number of pressures and of slowness factors.
const GRID: usize = 5;
/// Number of open times.
const OPEN_TIMES: usize = 21;
/// log₂ of the first steps of the open time (µs), 0.512 ms.
const FINE_BITS: u32 = 9;
/// Open time from which on the steps are twice as long (µs).
const FINE_END_US: i32 = 8 << FINE_BITS;
/// Fraction bits of a place between two points.
const FRACTION_BITS: u32 = 14;
/// log₂ of the pressure between two points, in 2⁻¹⁶ bar: 2 bar.
const PRESSURE_BITS: u32 = 17;

/// Values (µs) by slowness and pressure.
pub(super) type Block = [[u16; GRID]; GRID];

/// Tables of both valves.
#[derive(Debug)]
pub(super) struct PulseTable {
    pub(super) fill: ValveTable,
    pub(super) vent: ValveTable,
}

/// Tables of one valve (µs).
#[derive(Debug)]
pub(super) struct ValveTable {
    /// On-time of a run that gives each open time.
    pub(super) on_time_us: [Block; OPEN_TIMES],
    /// Open time of a run of one full period.
    pub(super) one_period_us: Block,
    /// Open time of a run of two full periods.
    pub(super) two_periods_us: Block,
    /// Time from the first edge until an open valve would have begun to pass its full flow.
    pub(super) opening_us: Block,
}

/// Slowness of a coil: time in which its current rises, relative to nominal voltage and resistance; 2⁻¹⁶, 0.5 ..= 1.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Slowness(i32);

impl Slowness {
    /// Slowness at nominal voltage and resistance.
    pub const NOMINAL: Self = Self(1 << 16);
    /// Smallest slowness of the tables.
    const MIN: i32 = 1 << 15;
    /// Largest slowness of the tables, less a unit: it belongs to their last cell.
    const MAX: i32 = (3 << 15) - 1;

    /// Returns the slowness for a factor of the duty limits, U₀/U · R/R₀, and the ratio R/R₀ in it: their product with
    /// 1 - 3/8 (R/R₀ - 1).
    ///
    /// A current I is reached after L/R ln(1/(1 - I R/U)) = L I/U (1 + I R/(2 U) + ...): in proportion to 1/U, and with a
    /// smaller influence of R. The share is that of the nominal plant from -40 to 120 °C (docs/equations.md).
    #[inline(always)]
    pub fn of(scale: DutyScale, resistance: ResistanceRatio) -> Self {
        // R/R₀ is at most 1.7, so the factor is at least 0.7; with a scale of 16 the product is below 2³⁸.
        let share = (11_i64 << 16).wrapping_sub((resistance.to_bits() as i64).wrapping_mul(3));
        let bits = (scale.to_bits() as i64).wrapping_mul(share) >> 19;
        Self(bits.clamp(Self::MIN as i64, Self::MAX as i64) as i32)
    }
}

/// Slowness of both coils.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CoilSlowness {
    /// Fill valve.
    pub fill: Slowness,
    /// Vent valve.
    pub vent: Slowness,
}

impl CoilSlowness {
    /// Both coils at nominal voltage and resistance.
    pub const NOMINAL: Self = Self {
        fill: Slowness::NOMINAL,
        vent: Slowness::NOMINAL,
    };
}

/// Place in a block: the cell, and the fractions within it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    row: usize,
    column: usize,
    row_fraction: i32,
    column_fraction: i32,
}

impl Place {
    /// Returns the place of a chamber pressure (bar gauge, 2⁻¹⁶), clamped to the table.
    #[inline(always)]
    pub(super) fn of(slowness: Slowness, pressure: i32) -> Self {
        let pressure = pressure.clamp(0, (4 << PRESSURE_BITS) - 1);
        let slowness = slowness.0.wrapping_sub(Slowness::MIN);
        let mask = (1 << FRACTION_BITS) - 1;
        Self {
            row: (slowness >> FRACTION_BITS) as usize & 3,
            column: (pressure >> PRESSURE_BITS) as usize & 3,
            row_fraction: slowness & mask,
            column_fraction: (pressure >> (PRESSURE_BITS - FRACTION_BITS)) & mask,
        }
    }

    /// Returns the value of the block at this place (µs), by linear interpolation.
    #[inline(always)]
    pub(super) fn value(self, block: &Block) -> i32 {
        let (low, high) = (&block[self.row], &block[self.row + 1]);
        let low = between(low[self.column], low[self.column + 1], self.column_fraction);
        let high = between(
            high[self.column],
            high[self.column + 1],
            self.column_fraction,
        );
        mixed(low, high, self.row_fraction)
    }
}

#[inline(always)]
fn between(low: u16, high: u16, fraction: i32) -> i32 {
    mixed(i32::from(low), i32::from(high), fraction)
}

/// Returns the value at a fraction of the way from `low` to `high`, both below 2¹⁷.
#[inline(always)]
fn mixed(low: i32, high: i32, fraction: i32) -> i32 {
    low.wrapping_add(high.wrapping_sub(low).wrapping_mul(fraction) >> FRACTION_BITS)
}

impl ValveTable {
    /// Returns the on-time of a run with this open time (µs), both of all its periods together. Beyond the table the
    /// valve is open, and both grow alike.
    #[inline(always)]
    pub(super) fn on_time(&self, place: Place, open_us: i32) -> i32 {
        let is_fine = open_us < FINE_END_US;
        let (cell, bits) = if is_fine {
            (open_us >> FINE_BITS, FINE_BITS)
        } else {
            let beyond = open_us.wrapping_sub(FINE_END_US);
            ((beyond >> (FINE_BITS + 1)).wrapping_add(8), FINE_BITS + 1)
        };
        let last = OPEN_TIMES as i32 - 2;
        if cell > last {
            let end_us = FINE_END_US + (12 << (FINE_BITS + 1));
            return place
                .value(&self.on_time_us[OPEN_TIMES - 1])
                .wrapping_add(open_us.wrapping_sub(end_us));
        }
        let cell = cell.max(0) as usize;
        let fraction = (open_us & ((1 << bits) - 1)) << (FRACTION_BITS - bits);
        mixed(
            place.value(&self.on_time_us[cell]),
            place.value(&self.on_time_us[cell + 1]),
            fraction,
        )
    }

    /// Returns the open time of a run of this number of full periods (µs).
    #[inline(always)]
    pub(super) fn open_time(&self, place: Place, periods: i32) -> i32 {
        if periods == 1 {
            return place.value(&self.one_period_us);
        }
        let beyond = periods.wrapping_sub(2).wrapping_mul(PERIOD_US);
        place.value(&self.two_periods_us).wrapping_add(beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pulses::tables::nominal_1_9_mm::TABLE;

    /// Block whose value at slowness row s and pressure column p is 1000 s + 100 p.
    const LINEAR: Block = [
        [0, 100, 200, 300, 400],
        [1_000, 1_100, 1_200, 1_300, 1_400],
        [2_000, 2_100, 2_200, 2_300, 2_400],
        [3_000, 3_100, 3_200, 3_300, 3_400],
        [4_000, 4_100, 4_200, 4_300, 4_400],
    ];

    #[test]
    fn a_block_is_interpolated_over_both_and_clamped_at_its_ends() {
        // Slowness in 2^-16, pressure in 2^-16 bar.
        for (slowness, pressure, expected) in [
            (1 << 15, 0, 0),
            (1 << 16, 0, 2_000),
            (1 << 16, 1 << 17, 2_100),
            ((1 << 16) + (1 << 13), 1 << 16, 2_550),
            ((1 << 16) + (1 << 13), 7 << 16, 2_850),
            (1 << 16, -(1 << 16), 2_000),
            (Slowness::MAX, 1 << 20, 4_398),
        ] {
            let found = Place::of(Slowness(slowness), pressure).value(&LINEAR);
            assert!(
                (found - expected).abs() <= 1,
                "{slowness} {pressure}: {found}"
            );
        }
    }

    #[test]
    fn the_on_time_meets_the_points_of_the_table_and_the_middle_between_them() {
        let place = Place::of(Slowness::NOMINAL, 4 << 16);
        let fill = &TABLE.fill;
        let at = |index: usize| i32::from(fill.on_time_us[index][2][2]);
        for (open_us, low, high) in [
            (0, 0, 0),
            (512, 1, 1),
            (256, 0, 1),
            (3_584, 7, 7),
            (3_840, 7, 8),
            (4_096, 8, 8),
            (4_608, 8, 9),
            (5_120, 9, 9),
            (15_360, 19, 19),
            (15_872, 19, 20),
        ] {
            let expected = (at(low) + at(high)) / 2;
            let found = fill.on_time(place, open_us);
            assert!(
                (found - expected).abs() <= 1,
                "{open_us}: {found} {expected}"
            );
        }
        assert_eq!(fill.on_time(place, 16_384), at(20));
        assert_eq!(fill.on_time(place, 26_384), at(20) + 10_000);
    }

    #[test]
    fn a_run_of_full_periods_gains_a_period_with_each_from_the_third_on() {
        let place = Place::of(Slowness::NOMINAL, 2 << 16);
        let vent = &TABLE.vent;
        let [one, two, three, four] = [1, 2, 3, 4].map(|periods| vent.open_time(place, periods));
        assert_eq!(one, i32::from(vent.one_period_us[2][1]));
        assert_eq!(two, i32::from(vent.two_periods_us[2][1]));
        assert_eq!([three - two, four - three], [PERIOD_US; 2]);
        assert!(two - one > PERIOD_US);
    }

    /// 18 V at 20 °C, and 24 V at 120 °C, where copper has 1.39 times the resistance.
    #[test]
    fn the_slowness_follows_the_voltage_fully_and_the_resistance_by_about_half() {
        let nominal = Slowness::of(DutyScale::ONE, ResistanceRatio::NOMINAL);
        assert_eq!(nominal, Slowness::NOMINAL);
        let of = |scale: f64, ratio: f64| {
            let scale = DutyScale::saturating_from_bits((scale * 65_536.0) as u32);
            let slowness = Slowness::of(scale, ResistanceRatio::of_bits((ratio * 65_536.0) as u32));
            f64::from(slowness.0) / 65_536.0
        };
        for (scale, ratio, expected) in [
            (1.0, 1.0, 1.0),
            (1.25, 1.0, 1.25),
            (1.39, 1.39, 1.187),
            (0.766, 0.766, 0.833),
            (0.1, 1.0, 0.5),
            (16.0, 1.7, 1.5),
        ] {
            let found = of(scale, ratio);
            assert!((found - expected).abs() < 1e-3, "{scale} {ratio}: {found}");
        }
    }
}
