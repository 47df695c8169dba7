//! Units that people write by mistake, with the factor to the unit of the key.

use crate::description::ParameterSpec;

/// (unit token at the end of a key, other token of the same quantity, factor from other to key unit).
const CONVERSIONS: &[(&str, &str, f64)] = &[
    ("_s", "_ms", 1e-3),
    ("_s", "_us", 1e-6),
    ("_hz", "_khz", 1e3),
    ("_v", "_mv", 1e-3),
    ("_ohm", "_kohm", 1e3),
    ("_ohm", "_mohm", 1e-3),
    ("_h", "_mh", 1e-3),
    ("_h", "_uh", 1e-6),
    ("_m", "_mm", 1e-3),
    ("_m", "_cm", 1e-2),
    ("_m", "_um", 1e-6),
    ("_m2", "_mm2", 1e-6),
    ("_m2", "_cm2", 1e-4),
    ("_m3", "_cm3", 1e-6),
    ("_m3", "_l", 1e-3),
    ("_m3", "_mm3", 1e-9),
    ("_kg", "_g", 1e-3),
    ("_n", "_mn", 1e-3),
    ("_n_per_m", "_n_per_mm", 1e3),
    ("_pa", "_bar", 1e5),
    ("_pa", "_kpa", 1e3),
    ("_pa", "_mbar", 1e2),
    ("_bar_gauge", "_kpa_gauge", 1e-2),
    ("_bar_gauge", "_pa_gauge", 1e-5),
    ("_bar_gauge", "_mpa_gauge", 10.0),
];

fn conversions(key: &str) -> impl Iterator<Item = (&'static str, &'static str, f64)> {
    // The longest unit at the end of the key is its unit: `_n_per_m` and not `_m`.
    let unit = CONVERSIONS
        .iter()
        .map(|conversion| conversion.0)
        .filter(|unit| key.ends_with(unit))
        .max_by_key(|unit| unit.len());
    CONVERSIONS
        .iter()
        .copied()
        .filter(move |conversion| Some(conversion.0) == unit)
}

/// Returns the parameter that `key` names in another unit, with the factor to its own unit.
pub(super) fn in_other_unit<'a>(
    key: &str,
    mut specs: impl Iterator<Item = &'a &'static ParameterSpec>,
) -> Option<(&'static ParameterSpec, f64)> {
    specs.find_map(|spec| {
        conversions(spec.key).find_map(|(unit, other, factor)| {
            let stem = spec.key.strip_suffix(unit)?;
            (key.strip_prefix(stem) == Some(other)).then_some((*spec, factor))
        })
    })
}

/// Returns `value` times `factor` without the rounding error of the binary product: 30 cm3 are 3e-5 m3.
pub(super) fn converted(value: f64, factor: f64) -> f64 {
    let product = value * factor;
    format!("{product:.14e}").parse().unwrap_or(product)
}

/// Returns the unit in which `value` would be plausible, with the value in the unit of the key.
pub(super) fn plausible_unit(spec: &ParameterSpec, value: f64) -> Option<(&'static str, f64)> {
    conversions(spec.key)
        .map(|(_, other, factor)| (&other[1..], converted(value, factor)))
        .find(|&(_, converted)| spec.contains(converted))
}
