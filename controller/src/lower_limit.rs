//! Lower limit of a duty cycle (sections 6.3.1 and 7.2).

use fixed::types::I16F16;

use crate::arithmetic::high_product;
use crate::error::ConfigError;
use crate::pressure::ERROR_SHIFT;
use crate::range::{Range, checked, propagate, quotient};
use crate::settings::{self, Distributor, OpeningDuty, Settings};
use crate::table::Field;

/// Dependence of the lower limit on the pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum LowerLimit {
    /// Constant: the same limit at every pressure.
    Constant,
    /// Duty cycle that just opens the valve against this pressure difference.
    ByPressure,
}

impl LowerLimit {
    pub(crate) const fn of(settings: &Settings) -> Self {
        match (settings.distributor, settings.duty_min) {
            (Distributor::Traditional, _) | (_, settings::LowerLimit::Constant { .. }) => {
                Self::Constant
            }
            (_, settings::LowerLimit::PressureDependent { .. }) => Self::ByPressure,
        }
    }
}

/// Supply pressure, at which the opening curves end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Supply {
    /// p_sup (bar), 2⁻²⁵, 1 ..= 15.
    pub(crate) pressure: i32,
    /// 2⁴⁶/p_sup with p_sup in 2⁻¹⁶ bar, rounded up so that the supply pressure itself gives exactly y = 1.
    reciprocal: i32,
}

impl Supply {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let supply = propagate!(checked(Field::SupplyPressure, settings.supply_pressure_bar));
        // The supply pressure is at least 1 bar, 2¹⁶ units.
        let divisor = supply as u128;
        let reciprocal = quotient(
            (1_u128 << 46).wrapping_add(divisor).wrapping_sub(1),
            divisor,
        );
        Ok(Self {
            pressure: supply << ERROR_SHIFT,
            reciprocal: reciprocal as i32,
        })
    }

    /// Returns y = Δp/p_sup, clamped to 0 ..= 1, 2⁻²⁴, for a pressure difference (bar), 2⁻²⁵.
    #[inline(always)]
    fn share(&self, difference: i32) -> i32 {
        // A factor of at most 2²⁹ · 2 and a factor of at most 2³⁰.
        high_product(difference.max(0).min(self.pressure) << 1, self.reciprocal)
    }
}

/// Field names of the three points of an [`OpeningDuty`], as error messages show them.
#[derive(Clone, Copy)]
pub(crate) struct OpeningFields {
    pub(crate) without_pressure: Field,
    pub(crate) at_half: Field,
    pub(crate) with_supply_pressure: Field,
}

/// Duty cycle that just opens a valve, as a parabola over the pressure difference that helps to open it: D(y) = D₀ -
/// (a + b y) y with y = Δp/p_sup from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct OpeningCurve {
    /// D₀ (%), 2⁻¹⁶.
    without_pressure: i32,
    /// a (%), 2⁻¹⁶, 0 ..= 200.
    slope: i32,
    /// b (%), 2⁻²⁴, -100 ..= 100.
    curvature: i32,
}

impl OpeningCurve {
    /// Creates a constant curve with this limit (%), 2⁻¹⁶.
    pub(crate) const fn level(limit: i32) -> Self {
        Self {
            without_pressure: limit,
            slope: 0,
            curvature: 0,
        }
    }

    /// Creates the curve through the three points; an error if it does not fall along its whole length.
    pub(crate) const fn new(
        opening: &OpeningDuty,
        fields: OpeningFields,
    ) -> Result<Self, ConfigError> {
        let OpeningDuty {
            without_pressure_pct,
            at_half_pct,
            with_supply_pressure_pct,
        } = *opening;
        let without = propagate!(checked(fields.without_pressure, without_pressure_pct));
        let range = Range::of(fields.with_supply_pressure).up_to(without_pressure_pct);
        let with = propagate!(range.checked_not_above(
            fields.without_pressure,
            fields.with_supply_pressure,
            with_supply_pressure_pct
        ));
        // From here all values are within 0 ..= 100 %, so no sum below overflows a word.
        let drop = without.wrapping_sub(with);
        let range = Range::between(
            I16F16::from_bits(with.wrapping_add(drop / 4)),
            I16F16::from_bits(without.wrapping_sub(drop / 4)),
        );
        let at_half = propagate!(range.checked(fields.at_half, at_half_pct));
        let drop_at_half = without.wrapping_sub(at_half);
        Ok(Self {
            without_pressure: without,
            slope: drop_at_half.wrapping_mul(4).wrapping_sub(drop),
            curvature: drop
                .wrapping_mul(2)
                .wrapping_sub(drop_at_half.wrapping_mul(4))
                << 8,
        })
    }

    /// Returns D₀ (%), 2⁻¹⁶.
    #[inline(always)]
    pub(crate) const fn without_pressure(&self) -> i32 {
        self.without_pressure
    }

    /// Returns D₀ - D(y) (%), 2⁻¹⁶: the reduction of the limit by this pressure difference, from 0 to D₀ - D(1).
    #[inline(always)]
    pub(crate) fn drop(&self, supply: &Supply, difference: i32) -> i32 {
        let share = supply.share(difference);
        // a + b y is 0 ..= 200 % (to a unit), because the middle point is in the middle half. Shifts by 7 and 1 bits
        // give 2⁻¹⁶ % again.
        let gradient = self.slope.wrapping_add(high_product(self.curvature, share));
        // Both products are rounded down, so no limit is too low. On a level part of the curve a limit could be a unit
        // too high.
        high_product(gradient << 7, share << 1).max(0)
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

    /// Goal: rounding never moves a limit beyond the ends of a curve; curves that are level over a unit are the
    /// critical ones. Method: all of the flattest allowed curves, along their whole length and beyond.
    #[test]
    fn the_flattest_curves_stay_within_their_ends() {
        let with = 1_867_776;
        for bits in [1 << 16, 550_502, 15 << 16] {
            let settings = Settings {
                supply_pressure_bar: I16F16::from_bits(bits),
                ..Settings::thesis()
            };
            let supply = Supply::new(&settings).expect("1 to 15 bar are allowed");
            for drop in 0..12 {
                for drop_at_half in drop / 4..=drop - drop / 4 {
                    let unit = |bits| I16F16::from_bits(bits);
                    let opening = OpeningDuty {
                        without_pressure_pct: unit(with + drop),
                        at_half_pct: unit(with + drop - drop_at_half),
                        with_supply_pressure_pct: unit(with),
                    };
                    let curve =
                        OpeningCurve::new(&opening, FIELDS).expect("the middle half is allowed");
                    let at = |difference: i32| {
                        curve.without_pressure() - curve.drop(&supply, difference << ERROR_SHIFT)
                    };
                    for difference in (-bits / 8..bits + bits / 8).step_by(997) {
                        let duty = at(difference);
                        assert!(
                            (with..=with + drop).contains(&duty),
                            "{duty} at {difference} on {curve:?}"
                        );
                    }
                    assert_eq!((at(0), at(bits)), (with + drop, with));
                }
            }
        }
    }
}
