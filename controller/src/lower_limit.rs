//! The lower limit of a duty cycle, sections 6.3.1 and 7.2.

use fixed::types::I16F16;

use crate::arithmetic::high_product;
use crate::error::{ConfigError, Field};
use crate::range::checked;
use crate::settings::OpeningDuty;

/// DC_min of one valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum LowerLimit {
    /// The same at every pressure [%], 2⁻¹⁶.
    Constant(i32),
    /// What just opens the valve against this pressure difference.
    ByPressure(OpeningCurve),
}

impl LowerLimit {
    /// The limit [2⁻¹⁶ %] at the pressure difference [2⁻¹⁶ bar] that helps the valve to open.
    #[inline(always)]
    pub(crate) fn at(&self, difference: i32) -> i32 {
        match self {
            Self::Constant(limit) => *limit,
            Self::ByPressure(curve) => curve.at(difference),
        }
    }
}

/// The names under which errors show the three points of an [`OpeningDuty`].
#[derive(Clone, Copy)]
pub(crate) struct OpeningFields {
    pub(crate) without_pressure: Field,
    pub(crate) at_half: Field,
    pub(crate) with_supply_pressure: Field,
}

/// The duty cycle that just opens a valve, a parabola of the pressure difference that helps:
/// D(y) = D₀ - (a + b y) y with y = Δp/p_sup from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct OpeningCurve {
    /// p_sup [bar], 2⁻¹⁶, 1 ..= 15.
    supply: i32,
    /// 2⁴⁶/p_sup, rounded up so that the supply pressure itself gives exactly y = 1.
    reciprocal: i32,
    /// D₀ [%], 2⁻¹⁶.
    without_pressure: i32,
    /// D(1) [%], 2⁻¹⁶.
    with_supply_pressure: i32,
    /// a [%], 2⁻¹⁶, 0 ..= 200.
    slope: i32,
    /// b [%], 2⁻²⁴, -100 ..= 100.
    curvature: i32,
}

impl OpeningCurve {
    /// The curve through the three points, if it falls all the way. `supply` has been checked.
    pub(crate) fn new(
        opening: &OpeningDuty,
        supply: I16F16,
        fields: OpeningFields,
    ) -> Result<Self, ConfigError> {
        let hundred = I16F16::lit("100");
        let without = checked(
            fields.without_pressure,
            opening.without_pressure_pct,
            I16F16::ZERO,
            hundred,
        )?;
        let with = opening.with_supply_pressure_pct;
        if with > without {
            return Err(ConfigError::AboveOther {
                field: fields.with_supply_pressure,
                value: with,
                other: fields.without_pressure,
                min: I16F16::ZERO,
                max: without,
            });
        }
        let with = checked(fields.with_supply_pressure, with, I16F16::ZERO, hundred)?;
        // All within 0 ..= 100 % from here: no sum below leaves a word.
        let drop = without.to_bits() - with.to_bits();
        let quarter = I16F16::from_bits(drop / 4);
        let at_half = checked(
            fields.at_half,
            opening.at_half_pct,
            with + quarter,
            without - quarter,
        )?;
        let drop_at_half = without.to_bits() - at_half.to_bits();
        let supply = supply.to_bits();
        Ok(Self {
            supply,
            reciprocal: ((1_i64 << 46) + i64::from(supply) - 1)
                .checked_div(i64::from(supply))
                .unwrap_or(0) as i32,
            without_pressure: without.to_bits(),
            with_supply_pressure: with.to_bits(),
            slope: 4 * drop_at_half - drop,
            curvature: (2 * drop - 4 * drop_at_half) << 8,
        })
    }

    /// The opening duty cycle [2⁻¹⁶ %], within the two ends.
    #[inline(always)]
    fn at(&self, difference: i32) -> i32 {
        // y [2⁻²⁴]: at most 2²⁰ · 2¹⁰ times at most 2³⁰.
        let share = high_product(difference.max(0).min(self.supply) << 10, self.reciprocal);
        // a + b y is 0 ..= 200 % (to a unit), as the middle point is in the middle half; 7 and 1 bits up give 2⁻¹⁶ % again.
        let gradient = self.slope.wrapping_add(high_product(self.curvature, share));
        let opening = self
            .without_pressure
            .wrapping_sub(high_product(gradient << 7, share << 1));
        // Where the curve is level, the rounding could step over an end by one unit.
        opening
            .min(self.without_pressure)
            .max(self.with_supply_pressure)
    }
}
