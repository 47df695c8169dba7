//! Hard bounds of every quantity: a value beyond them is no measurement, under any mapping.

use std::fmt;
use std::ops::RangeInclusive;

use crate::{Quantity, STANDARD_ATMOSPHERE_PA, Unit};

/// Possible values of a quantity. Computations on a log work for all values within them.
///
/// A measured cell outside counts as missing and is listed ([`OutOfBounds`]). If half of a column or more is outside,
/// or a duty cycle or a time is, the file is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest value, in [`Bounds::unit`].
    pub least: f64,
    /// Largest value, in [`Bounds::unit`].
    pub most: f64,
    /// Unit of the bounds; absolute for a pressure.
    pub unit: Unit,
    /// Reason why no measurement is beyond the bounds.
    pub reason: &'static str,
}

/// Returns the symmetric bounds of a signed quantity.
const fn within(most: f64, unit: Unit, reason: &'static str) -> Bounds {
    between(-most, most, unit, reason)
}

const fn between(least: f64, most: f64, unit: Unit, reason: &'static str) -> Bounds {
    Bounds {
        least,
        most,
        unit,
        reason,
    }
}

const LARGE: &str = "far beyond any machine with a valve";

impl Bounds {
    /// Returns the bounds of `quantity`.
    pub const fn of(quantity: Quantity) -> Self {
        use Quantity as Q;
        match quantity {
            Q::Time => within(
                1e10,
                Unit::Second,
                "three centuries, with any clock's epoch",
            ),
            Q::Pressure => between(
                0.001,
                1000.0,
                Unit::BarAbsolute,
                "from fine vacuum to the strongest gas cylinder three times over",
            ),
            Q::PressureDifference => within(1000.0, Unit::BarDifference, "that of two pressures"),
            Q::Current => within(1000.0, Unit::Ampere, "a starter motor's, a thousand coils'"),
            Q::Voltage => within(
                1000.0,
                Unit::Volt,
                "five times a vehicle's load dump (ISO 7637)",
            ),
            Q::DutyCycle => between(0.0, 100.0, Unit::Percent, "off to on"),
            Q::Ratio => within(1e6, Unit::Fraction, LARGE),
            Q::Length => within(1e6, Unit::Metre, LARGE),
            Q::Velocity => within(1e5, Unit::MetrePerSecond, LARGE),
            Q::Acceleration => within(1e7, Unit::MetrePerSecondSquared, LARGE),
            Q::Area => within(1e6, Unit::SquareMetre, LARGE),
            Q::Volume => within(1e6, Unit::CubicMetre, LARGE),
            Q::Temperature => between(
                0.0,
                3000.0,
                Unit::Kelvin,
                "from absolute zero to beyond any thermocouple",
            ),
            Q::Mass => within(1e9, Unit::Kilogram, LARGE),
            Q::MassFlow => within(1e6, Unit::KilogramPerSecond, LARGE),
            Q::VolumeFlow => within(1e6, Unit::CubicMetrePerSecond, LARGE),
            Q::Force => within(1e9, Unit::Newton, LARGE),
            Q::Torque => within(1e9, Unit::NewtonMetre, LARGE),
            Q::RotationalSpeed => within(1e7, Unit::RadianPerSecond, LARGE),
            Q::Frequency => within(1e12, Unit::Hertz, LARGE),
            Q::Resistance => within(1e12, Unit::Ohm, LARGE),
            Q::Inductance => within(1e6, Unit::Henry, LARGE),
            Q::FluxLinkage => within(1e6, Unit::VoltSecond, LARGE),
            Q::Power => within(1e12, Unit::Watt, LARGE),
            Q::Energy => within(1e15, Unit::Joule, LARGE),
            Q::Count => within(18_446_744_073_709_551_615.0, Unit::Count, "64 bits"),
        }
    }

    /// Returns the bounds in `unit` of the same quantity; gauge pressures are relative to the standard atmosphere.
    pub fn in_unit(&self, unit: Unit) -> RangeInclusive<f64> {
        match self.unit.converter_at_ambient(unit, STANDARD_ATMOSPHERE_PA) {
            Ok(converter) => converter.apply(self.least)..=converter.apply(self.most),
            // The unit of a ratio that its name makes a duty cycle, or a unit of another quantity: no value is outside.
            Err(_) => f64::MIN..=f64::MAX,
        }
    }
}

/// Cells of one signal with values outside the [`Bounds`] of its quantity; they count as missing.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfBounds {
    /// Name of the signal.
    pub signal: String,
    /// Unit of the values.
    pub unit: Unit,
    /// Allowed range, in this unit.
    pub allowed: RangeInclusive<f64>,
    /// Column in a CSV file, from 1; `None` in MF4.
    pub column: Option<usize>,
    /// Number of such cells.
    pub count: u64,
    /// First of these cells, at most [`OutOfBounds::LISTED_MAX`].
    pub first: Vec<Outlier>,
}

/// Cell outside the bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Line in a CSV file, from 1; sample in MF4, from 0.
    pub place: u64,
    /// Value after scale and offset.
    pub value: f64,
}

impl OutOfBounds {
    /// Maximum number of listed cells.
    pub const LISTED_MAX: usize = 10;

    pub(crate) fn new(signal: &str, unit: Unit, bounds: &Bounds, column: Option<usize>) -> Self {
        Self {
            signal: signal.to_owned(),
            unit,
            allowed: bounds.in_unit(unit),
            column,
            count: 0,
            first: Vec::new(),
        }
    }

    pub(crate) fn add(&mut self, value: f64, place: u64) {
        self.count += 1;
        if self.first.len() < Self::LISTED_MAX {
            self.first.push(Outlier { place, value });
        }
    }

    /// Returns the place of an outlier: line and column, or sample.
    pub fn place(&self, outlier: &Outlier) -> String {
        match self.column {
            Some(column) => format!("line {}, column {column}", outlier.place),
            None => format!("sample {}", outlier.place),
        }
    }
}

/// One sentence with the number of cells, the allowed range, and the places of the first cells.
impl fmt::Display for OutOfBounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Maximum number of cells in the sentence.
        const NAMED_MAX: usize = 3;
        let cells = if self.count == 1 { "cell" } else { "cells" };
        write!(
            f,
            "{} {cells} of {} out of bounds ({}), counted as missing: ",
            self.count,
            self.signal,
            Allowed(&self.allowed, self.unit)
        )?;
        for (index, outlier) in self.first.iter().take(NAMED_MAX).enumerate() {
            let comma = if index > 0 { "; " } else { "" };
            let place = self.place(outlier);
            write!(
                f,
                "{comma}{place}: {} {}",
                Short(outlier.value),
                self.unit.symbol()
            )?;
        }
        if self.count > NAMED_MAX as u64 {
            write!(f, "; and {} more", self.count - NAMED_MAX as u64)?;
        }
        Ok(())
    }
}

/// Number of any size, in few characters.
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.abs() {
            size if size == 0.0 || (1e-3..1e9).contains(&size) => write!(f, "{}", self.0),
            _ => write!(f, "{:e}", self.0),
        }
    }
}

/// Range of values with its unit, to six digits.
pub(crate) struct Allowed<'a>(pub(crate) &'a RangeInclusive<f64>, pub(crate) Unit);

impl fmt::Display for Allowed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [least, most] = [self.0.start(), self.0.end()].map(|end| {
            let scale = 10_f64.powf(5.0 - end.abs().max(1.0).log10().floor());
            (end * scale).round() / scale
        });
        write!(
            f,
            "allowed: {} to {} {}",
            Short(least),
            Short(most),
            self.1.symbol()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_has_bounds_that_are_a_range_in_it() {
        for unit in Unit::all() {
            let range = Bounds::of(unit.quantity()).in_unit(unit);
            assert!(range.start() < range.end(), "{unit}: {range:?}");
            assert!(
                range.start().is_finite() && range.end().abs() < 1e22,
                "{unit}: {range:?}"
            );
        }
        let duty = Bounds::of(Quantity::DutyCycle).in_unit(Unit::Fraction);
        assert_eq!(duty, 0.0..=1.0);
    }

    #[test]
    fn a_gauge_pressure_is_above_vacuum_at_the_standard_atmosphere() {
        let gauge = Bounds::of(Quantity::Pressure).in_unit(Unit::BarGauge);
        assert!(!gauge.contains(&-1.0133) && gauge.contains(&-1.0) && gauge.contains(&998.0));
        assert!(!gauge.contains(&1000.0));
        let absolute = Bounds::of(Quantity::Pressure).in_unit(Unit::PascalAbsolute);
        assert!(!absolute.contains(&0.0) && absolute.contains(&1e5));
    }

    #[test]
    fn outliers_are_reported_with_place_value_and_bounds() {
        let bounds = Bounds::of(Quantity::Current);
        let mut cells = OutOfBounds::new("i_fill", Unit::Milliampere, &bounds, Some(5));
        for line in 2..20 {
            cells.add(1e200, line);
        }
        assert_eq!(
            (cells.count, cells.first.len()),
            (18, OutOfBounds::LISTED_MAX)
        );
        let text = cells.to_string();
        assert!(
            text.starts_with(
                "18 cells of i_fill out of bounds (allowed: -1000000 to 1000000 mA), counted as missing: line 2, column 5: 1e200 mA;"
            ) && text.ends_with("; and 15 more"),
            "{text}"
        );
    }
}
