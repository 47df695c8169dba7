//! Units of measurement: a closed set, each with its quantity and its exact scale.

mod table;

use std::fmt;

use crate::Quantity;
use table::{Entry, TABLE};

/// Standard atmosphere (Pa), for a log whose ambient pressure was not measured (ISO 2533).
pub const STANDARD_ATMOSPHERE_PA: f64 = 101_325.0;

/// Reference of a pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PressureReference {
    /// Relative to the atmosphere.
    Gauge,
    /// Relative to vacuum.
    Absolute,
}

/// Unit in which a signal can be logged.
///
/// The *token* is the form used as a suffix of a column name and in mapping files (`bar_gauge`, `mA`, `pct`);
/// the *symbol* is the form for axes and tables (`bar gauge`, `mA`, `%`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Unit {
    /// Second.
    Second,
    /// Millisecond.
    Millisecond,
    /// Microsecond.
    Microsecond,
    /// Nanosecond.
    Nanosecond,
    /// Minute.
    Minute,
    /// Hour.
    Hour,
    /// Pascal above the atmosphere.
    PascalGauge,
    /// Pascal above vacuum.
    PascalAbsolute,
    /// Kilopascal above the atmosphere.
    KilopascalGauge,
    /// Kilopascal above vacuum.
    KilopascalAbsolute,
    /// Megapascal above the atmosphere.
    MegapascalGauge,
    /// Megapascal above vacuum.
    MegapascalAbsolute,
    /// Millibar above the atmosphere.
    MillibarGauge,
    /// Millibar above vacuum.
    MillibarAbsolute,
    /// Bar above the atmosphere.
    BarGauge,
    /// Bar above vacuum.
    BarAbsolute,
    /// Psi above the atmosphere.
    PsiGauge,
    /// Psi above vacuum.
    PsiAbsolute,
    /// Pascal, of a pressure difference.
    PascalDifference,
    /// Kilopascal, of a pressure difference.
    KilopascalDifference,
    /// Millibar, of a pressure difference.
    MillibarDifference,
    /// Bar, of a pressure difference.
    BarDifference,
    /// Ampere.
    Ampere,
    /// Milliampere.
    Milliampere,
    /// Microampere.
    Microampere,
    /// Volt.
    Volt,
    /// Millivolt.
    Millivolt,
    /// Percent, of a duty cycle or of any other ratio.
    Percent,
    /// Per mille.
    PerMille,
    /// Fraction, 1 is the whole.
    Fraction,
    /// Metre.
    Metre,
    /// Millimetre.
    Millimetre,
    /// Micrometre.
    Micrometre,
    /// Metre per second.
    MetrePerSecond,
    /// Millimetre per second.
    MillimetrePerSecond,
    /// Kilometre per hour.
    KilometrePerHour,
    /// Metre per second squared.
    MetrePerSecondSquared,
    /// Square metre.
    SquareMetre,
    /// Square millimetre.
    SquareMillimetre,
    /// Cubic metre.
    CubicMetre,
    /// Litre.
    Litre,
    /// Millilitre.
    Millilitre,
    /// Kelvin.
    Kelvin,
    /// Degree Celsius.
    DegreeCelsius,
    /// Degree Fahrenheit.
    DegreeFahrenheit,
    /// Kilogram.
    Kilogram,
    /// Gram.
    Gram,
    /// Milligram.
    Milligram,
    /// Kilogram per second.
    KilogramPerSecond,
    /// Gram per second.
    GramPerSecond,
    /// Cubic metre per second.
    CubicMetrePerSecond,
    /// Litre per minute.
    LitrePerMinute,
    /// Newton.
    Newton,
    /// Millinewton.
    Millinewton,
    /// Kilonewton.
    Kilonewton,
    /// Newton metre.
    NewtonMetre,
    /// Radian per second.
    RadianPerSecond,
    /// Revolution per minute.
    RevolutionPerMinute,
    /// Hertz.
    Hertz,
    /// Kilohertz.
    Kilohertz,
    /// Ohm.
    Ohm,
    /// Kiloohm.
    Kiloohm,
    /// Henry.
    Henry,
    /// Millihenry.
    Millihenry,
    /// Volt second.
    VoltSecond,
    /// Millivolt second.
    MillivoltSecond,
    /// Watt.
    Watt,
    /// Kilowatt.
    Kilowatt,
    /// Joule.
    Joule,
    /// Millijoule.
    Millijoule,
    /// Number of things.
    Count,
}

impl Unit {
    /// Returns all units, grouped by quantity.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.unit)
    }

    /// Returns the unit written as `text`: a token, a symbol or a customary spelling such as `barg`, `%` or `°C`.
    ///
    /// Letter case is significant, because `mPa` and `MPa` are nine decades apart.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        TABLE
            .iter()
            .find(|entry| {
                entry.token == text
                    || entry.aliases.contains(&text)
                    // `bar` and `kPa` are symbols of differences; as a declaration they leave the reference open.
                    || (entry.symbol == text && entry.quantity != Quantity::PressureDifference)
            })
            .map(|entry| entry.unit)
    }

    /// Returns the form used in column names and mapping files.
    pub fn token(self) -> &'static str {
        self.entry().token
    }

    /// Returns the form used on axes and in tables.
    pub fn symbol(self) -> &'static str {
        self.entry().symbol
    }

    /// Returns the quantity of this unit. A percentage is a [`Quantity::Ratio`] unless a signal's name makes it a duty
    /// cycle.
    pub fn quantity(self) -> Quantity {
        self.entry().quantity
    }

    /// Returns gauge or absolute for units of pressure.
    pub fn pressure_reference(self) -> Option<PressureReference> {
        self.entry().reference
    }

    /// Returns the conversion to `to`, if it needs no ambient pressure.
    ///
    /// # Errors
    /// Returns [`ConversionError::DifferentQuantity`], or [`ConversionError::AmbientNeeded`] between gauge and
    /// absolute.
    pub fn converter(self, to: Self) -> Result<Converter, ConversionError> {
        if self.pressure_reference() != to.pressure_reference() && self.quantity() == to.quantity()
        {
            return Err(ConversionError::AmbientNeeded { from: self, to });
        }
        self.converter_from_offsets(to, self.entry().offset, to.entry().offset)
    }

    /// Returns the conversion to `to` at the ambient pressure `ambient_pressure_pa` (Pa absolute), which matters only
    /// between gauge and absolute.
    ///
    /// # Errors
    /// Returns [`ConversionError::DifferentQuantity`], or [`ConversionError::AmbientImpossible`] unless the ambient
    /// pressure is positive and finite.
    pub fn converter_at_ambient(
        self,
        to: Self,
        ambient_pressure_pa: f64,
    ) -> Result<Converter, ConversionError> {
        if !(ambient_pressure_pa.is_finite() && ambient_pressure_pa > 0.0) {
            return Err(ConversionError::AmbientImpossible {
                ambient_pressure_pa,
            });
        }
        let offset = |unit: Self| match unit.pressure_reference() {
            Some(PressureReference::Gauge) => ambient_pressure_pa,
            _ => unit.entry().offset,
        };
        self.converter_from_offsets(to, offset(self), offset(to))
    }

    /// Converts `value` from this unit into `to`. See [`Unit::converter`].
    ///
    /// # Errors
    /// Returns the errors of [`Unit::converter`].
    pub fn convert(self, value: f64, to: Self) -> Result<f64, ConversionError> {
        Ok(self.converter(to)?.apply(value))
    }

    fn converter_from_offsets(
        self,
        to: Self,
        offset_from: f64,
        offset_to: f64,
    ) -> Result<Converter, ConversionError> {
        let (from, into) = (self.entry(), to.entry());
        if from.quantity != into.quantity {
            return Err(ConversionError::DifferentQuantity { from: self, to });
        }
        let (numerator, denominator) = (from.times * into.over, from.over * into.times);
        let shift = (offset_from - offset_to) * into.over / into.times;
        Ok(if numerator >= denominator {
            Converter {
                multiply: numerator / denominator,
                divide: 1.0,
                shift,
            }
        } else {
            Converter {
                multiply: 1.0,
                divide: denominator / numerator,
                shift,
            }
        })
    }

    fn entry(self) -> &'static Entry {
        &TABLE[self as usize]
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.symbol())
    }
}

/// Checked conversion between two units of one quantity.
///
/// It multiplies or divides, never by a rounded reciprocal: 0.05 ms is exactly the f64 nearest to 5e-5 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Converter {
    multiply: f64,
    divide: f64,
    shift: f64,
}

impl Converter {
    /// Returns the converted value. NaN (a missing sample) stays NaN; between equal units every bit is unchanged.
    pub fn apply(&self, value: f64) -> f64 {
        let scaled = value * self.multiply / self.divide;
        // Adding 0.0 would turn -0.0 into 0.0.
        if self.shift == 0.0 {
            scaled
        } else {
            scaled + self.shift
        }
    }
}

/// Reason why two units do not convert.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConversionError {
    /// The units belong to different quantities.
    #[error("{from} is a {}, {to} is a {}: convert within one quantity", from.quantity(), to.quantity())]
    DifferentQuantity {
        /// Unit of the value.
        from: Unit,
        /// Wanted unit.
        to: Unit,
    },
    /// Gauge and absolute pressure differ by the ambient pressure, which was not given.
    #[error(
        "{from} to {to} depends on the ambient pressure: give it (standard atmosphere: 101325 Pa)"
    )]
    AmbientNeeded {
        /// Unit of the value.
        from: Unit,
        /// Wanted unit.
        to: Unit,
    },
    /// The ambient pressure is not positive and finite.
    #[error(
        "an ambient pressure of {ambient_pressure_pa} Pa is impossible: give a positive absolute pressure"
    )]
    AmbientImpossible {
        /// Given ambient pressure (Pa absolute).
        ambient_pressure_pa: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_one_line_per_unit_in_the_order_of_the_enum() {
        for (line, entry) in TABLE.iter().enumerate() {
            assert_eq!(entry.unit as usize, line, "{}", entry.token);
        }
    }

    #[test]
    fn every_spelling_names_one_unit() {
        let mut seen = std::collections::BTreeMap::new();
        for entry in TABLE {
            for spelling in std::iter::once(&entry.token).chain(entry.aliases) {
                assert_eq!(
                    seen.insert(*spelling, entry.unit),
                    None,
                    "{spelling} is used twice"
                );
                assert_eq!(Unit::parse(spelling), Some(entry.unit), "{spelling}");
            }
        }
    }

    #[test]
    fn conversion_there_and_back_stays_within_two_roundings() {
        for from in Unit::all() {
            for to in Unit::all().filter(|to| to.quantity() == from.quantity()) {
                let there = from
                    .converter_at_ambient(to, STANDARD_ATMOSPHERE_PA)
                    .unwrap();
                let back = to
                    .converter_at_ambient(from, STANDARD_ATMOSPHERE_PA)
                    .unwrap();
                for value in [-3.7, 0.0, 0.05, 123.456] {
                    let error = (back.apply(there.apply(value)) - value).abs();
                    let largest_term =
                        value.abs() + there.shift.abs() * back.multiply / back.divide;
                    assert!(
                        error <= 4.0 * f64::EPSILON * largest_term,
                        "{from} -> {to}: {value} off by {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn known_pairs_convert_exactly() {
        let pairs = [
            (1.0, Unit::BarGauge, 100.0, Unit::KilopascalGauge),
            (0.05, Unit::Millisecond, 5e-5, Unit::Second),
            (292.0, Unit::Milliampere, 0.292, Unit::Ampere),
            (28.5, Unit::Percent, 0.285, Unit::Fraction),
            (20.0, Unit::DegreeCelsius, 293.15, Unit::Kelvin),
            (36.0, Unit::KilometrePerHour, 10.0, Unit::MetrePerSecond),
        ];
        for (value, from, expected, to) in pairs {
            assert_eq!(
                from.convert(value, to),
                Ok(expected),
                "{value} {from} in {to}"
            );
        }
        let boiling = Unit::DegreeFahrenheit
            .convert(212.0, Unit::DegreeCelsius)
            .unwrap();
        assert!((boiling - 100.0).abs() < 1e-12, "{boiling}");
    }

    #[test]
    fn gauge_to_absolute_asks_for_the_ambient_pressure_and_uses_it() {
        let (from, to) = (Unit::BarGauge, Unit::KilopascalAbsolute);
        assert_eq!(
            from.converter(to),
            Err(ConversionError::AmbientNeeded { from, to })
        );
        assert_eq!(
            from.converter_at_ambient(to, 95_000.0).unwrap().apply(2.0),
            295.0
        );
        assert_eq!(
            to.converter_at_ambient(from, 95_000.0).unwrap().apply(95.0),
            0.0
        );
        for ambient_pressure_pa in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(
                from.converter_at_ambient(to, ambient_pressure_pa).is_err(),
                "{ambient_pressure_pa}"
            );
        }
    }

    #[test]
    fn equal_units_keep_every_bit() {
        for value in [-0.0, 5e-324, f64::MAX, 0.1] {
            let same = Unit::BarGauge.convert(value, Unit::BarGauge).unwrap();
            assert_eq!(same.to_bits(), value.to_bits());
        }
    }

    #[test]
    fn a_pressure_without_reference_is_no_unit() {
        for text in ["bar", "kPa", "psi", "Pa", "kpa_gauge", "mPa_gauge", ""] {
            assert_eq!(Unit::parse(text), None, "{text}");
        }
    }

    #[test]
    fn the_documentation_lists_every_token() {
        let readme = include_str!("../../README.md");
        for unit in Unit::all() {
            let token = unit.token();
            let listed = token.trim_end_matches("_gauge").trim_end_matches("_abs");
            assert!(readme.contains(&format!("`{listed}`")), "{token}");
        }
    }
}
