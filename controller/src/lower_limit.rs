//! The lower limit of a duty cycle, sections 6.3.1 and 7.2.

use fixed::types::I16F16;

use crate::arithmetic::high_product;
use crate::error::{ConfigError, Field};
use crate::range::{Range, propagate, quotient};
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
    /// p_sup \[bar\], 2⁻¹⁶, 1 ..= 15.
    supply: i32,
    /// 2⁴⁶/p_sup, rounded up so that the supply pressure itself gives exactly y = 1.
    reciprocal: i32,
    /// D₀ [%], 2⁻¹⁶.
    without_pressure: i32,
    /// a [%], 2⁻¹⁶, 0 ..= 200.
    slope: i32,
    /// b [%], 2⁻²⁴, -100 ..= 100.
    curvature: i32,
}

impl OpeningCurve {
    /// The curve through the three points, if it falls all the way. `supply` [2⁻¹⁶ bar] has been checked.
    pub(crate) const fn new(
        opening: &OpeningDuty,
        supply: i32,
        fields: OpeningFields,
    ) -> Result<Self, ConfigError> {
        let OpeningDuty {
            without_pressure_pct,
            at_half_pct,
            with_supply_pressure_pct,
        } = *opening;
        let without =
            propagate!(Range::PERCENT.checked(fields.without_pressure, without_pressure_pct));
        let range = Range::PERCENT.up_to(without_pressure_pct);
        let with = propagate!(range.checked_not_above(
            fields.without_pressure,
            fields.with_supply_pressure,
            with_supply_pressure_pct
        ));
        // All within 0 ..= 100 % from here: no sum below leaves a word.
        let drop = without.wrapping_sub(with);
        let range = Range::between(
            I16F16::from_bits(with.wrapping_add(drop / 4)),
            I16F16::from_bits(without.wrapping_sub(drop / 4)),
        );
        let at_half = propagate!(range.checked(fields.at_half, at_half_pct));
        let drop_at_half = without.wrapping_sub(at_half);
        Ok(Self {
            supply,
            // The supply pressure is at least 1 bar, 2¹⁶ units.
            reciprocal: quotient(
                (1_u128 << 46).wrapping_add(supply as u128).wrapping_sub(1),
                supply as u128,
            ) as i32,
            without_pressure: without,
            slope: drop_at_half.wrapping_mul(4).wrapping_sub(drop),
            curvature: drop
                .wrapping_mul(2)
                .wrapping_sub(drop_at_half.wrapping_mul(4))
                << 8,
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
        // Both products are rounded down, so no opening is too small; where the curve is level, one could be a unit too large.
        opening.min(self.without_pressure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: OpeningFields = OpeningFields {
        without_pressure: Field::DutyMinFill,
        at_half: Field::DutyHalfFill,
        with_supply_pressure: Field::DutyMinFillWithSupplyPressure,
    };

    /// Goal: no rounding steps over an end, where it could: curves that are level over a unit. Method: all of the flattest
    /// curves that are allowed, along their whole length and beyond.
    #[test]
    fn the_flattest_curves_stay_within_their_ends() {
        let with = 1_867_776;
        for supply in [1 << 16, 550_502, 15 << 16] {
            for drop in 0..12 {
                for drop_at_half in drop / 4..=drop - drop / 4 {
                    let unit = |bits| I16F16::from_bits(bits);
                    let opening = OpeningDuty {
                        without_pressure_pct: unit(with + drop),
                        at_half_pct: unit(with + drop - drop_at_half),
                        with_supply_pressure_pct: unit(with),
                    };
                    let Ok(curve) = OpeningCurve::new(&opening, supply, FIELDS) else {
                        panic!("{opening:?} is allowed");
                    };
                    for difference in (-supply / 8..supply + supply / 8).step_by(997) {
                        let duty = curve.at(difference);
                        assert!(
                            (with..=with + drop).contains(&duty),
                            "{duty} at {difference} on {curve:?}"
                        );
                    }
                    assert_eq!((curve.at(0), curve.at(supply)), (with + drop, with));
                }
            }
        }
    }
}
