//! Unit of a column: its place in the header, its spelling, and the reference of a pressure.

use crate::csv::header::{parse_unit, with_reference};
use crate::csv::{Excerpt, Problem};
use crate::values::ColumnValues;
use crate::{PressureReference, Unit};

/// Unit of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum GuessedUnit {
    /// Complete unit.
    Unit(Unit),
    /// Pressure whose reference is open, such as `bar`.
    Pressure(String),
}

impl GuessedUnit {
    /// Returns the unit with this reference, if it states none.
    pub(super) fn completed(self, reference: Option<PressureReference>) -> Self {
        match (&self, reference) {
            (Self::Pressure(text), Some(reference)) => {
                with_reference(text, reference).map_or(self, Self::Unit)
            }
            _ => self,
        }
    }

    /// Returns the unit in the notation of a mapping.
    pub(crate) fn token(&self) -> &str {
        match self {
            Self::Unit(unit) => unit.token(),
            Self::Pressure(text) => text,
        }
    }
}

/// Place in a file from which a unit was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnitPlace {
    None,
    Own,
    Brackets,
    Suffix,
}

/// Splits a header into name and unit.
pub(super) fn split(header: &str, unit: &str) -> (String, String, UnitPlace) {
    let header = header.trim().trim_start_matches('\'').trim();
    let unit = unit.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('<', '>')] {
        let parts = header
            .strip_suffix(close)
            .and_then(|rest| rest.rsplit_once(open));
        if let Some((name, inner)) = parts.filter(|(name, _)| !name.trim().is_empty()) {
            return match unit.is_empty() {
                true => (
                    name.trim().to_owned(),
                    inner.trim().to_owned(),
                    UnitPlace::Brackets,
                ),
                false => (name.trim().to_owned(), unit.to_owned(), UnitPlace::Own),
            };
        }
    }
    let places = header.char_indices().filter(|&(at, character)| {
        at > 0 && matches!(character, '_' | '/' | ' ' | '-' | '.' | ',')
    });
    for (at, character) in places {
        let suffix = header[at + character.len_utf8()..].trim();
        let is_number = suffix.starts_with(|first: char| first.is_ascii_digit());
        if !is_number && known_unit(suffix).is_some() {
            let name = header[..at].trim_end_matches([' ', '_', '-', '/', '.', ',']);
            let name = name.strip_suffix(" in").unwrap_or(name).trim();
            return match unit.is_empty() {
                true => (name.to_owned(), suffix.to_owned(), UnitPlace::Suffix),
                false => (name.to_owned(), unit.to_owned(), UnitPlace::Own),
            };
        }
    }
    let place = match unit.is_empty() {
        true => UnitPlace::None,
        false => UnitPlace::Own,
    };
    (header.to_owned(), unit.to_owned(), place)
}

/// Returns the unit of a text, also in another letter case.
pub(super) fn known_unit(text: &str) -> Option<GuessedUnit> {
    match parse_unit(text, None) {
        Ok(unit) => return Some(GuessedUnit::Unit(unit)),
        Err(Problem::PressureReference { found }) => {
            return Some(GuessedUnit::Pressure(found.as_str().to_owned()));
        }
        Err(Problem::UnitUnknown {
            meant: Some(unit), ..
        }) => return Some(GuessedUnit::Unit(unit)),
        Err(_) => {}
    }
    // `mPa` and `MPa` differ in their letter case only.
    let pressures = ["bar", "mbar", "kPa", "hPa", "psi"].into_iter();
    let text = text.trim().trim_matches(['[', ']', '(', ')']);
    let found = pressures
        .clone()
        .find(|token| token.eq_ignore_ascii_case(text));
    found.map(|token| GuessedUnit::Pressure(token.to_owned()))
}

pub(super) fn unit_of(
    text: &str,
    place: UnitPlace,
    reference: Option<PressureReference>,
) -> (Option<GuessedUnit>, Option<String>) {
    let unit = known_unit(text).map(|unit| unit.completed(reference));
    let reason = match (place, &unit) {
        (UnitPlace::None, _) => None,
        (_, None) => Some(format!("unit {} is not known", Excerpt::of(text))),
        (UnitPlace::Own, _) => Some("unit given beside the name".to_owned()),
        (UnitPlace::Brackets, _) => Some("unit in brackets".to_owned()),
        (UnitPlace::Suffix, _) => Some("unit at the end of the name".to_owned()),
    };
    (unit, reason)
}

/// Returns the reference that the values suggest: a vented chamber shows the ambient pressure, which is 0 bar gauge.
pub(super) fn suggested_reference(
    unit: &str,
    values: &ColumnValues,
) -> Option<(PressureReference, String)> {
    let gauge = with_reference(unit, PressureReference::Gauge)?;
    let to_bar = gauge.converter(Unit::BarGauge).ok()?;
    let least_bar = to_bar.apply(values.least);
    let least = short(values.least);
    match least_bar {
        ..0.5 => Some((
            PressureReference::Gauge,
            format!("the least value, {least} {unit}, is below any ambient pressure"),
        )),
        0.8..=1.1 => Some((
            PressureReference::Absolute,
            format!("the least value, {least} {unit}, is that of the atmosphere"),
        )),
        _ => None,
    }
}

/// Returns a number with five digits.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.4e}");
    text.parse::<f64>().map_or(text, |value| value.to_string())
}
