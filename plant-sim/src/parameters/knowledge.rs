//! Reader and writer of the knowledge about a value of a plant file.
//!
//! ```toml
//! volume_m3 = 75e-6                                    # the usual tolerance of the part
//! volume_m3 = { value = 75e-6, exact = true }
//! volume_m3 = { value = 75e-6, tolerance_pct = 30 }
//! command_delay_s = { value = 15e-3, tolerance = 6e-3 }     # in the unit of the key
//! volume_m3 = { min = 40e-6, max = 120e-6 }
//! volume_m3 = "unknown"
//! ```

use toml_edit::{Item, TableLike, Value};

use super::NOMINAL_PLANT_TOML;
use crate::description::{Knowledge, ParameterSpec, middle};

const VALUE: &str = "value";
const EXACT: &str = "exact";
const TOLERANCE_PCT: &str = "tolerance_pct";
const TOLERANCE: &str = "tolerance";
const MIN: &str = "min";
const MAX: &str = "max";
const UNKNOWN: &str = "unknown";
const KEYS: [&str; 6] = [VALUE, EXACT, TOLERANCE_PCT, TOLERANCE, MIN, MAX];

/// Allowed forms of a value, for messages.
pub(super) const FORMS: &str = "a number, { value = V, tolerance_pct = T }, { value = V, tolerance = T }, \
    { value = V, exact = true }, { min = A, max = B } or \"unknown\"";

/// Returns the value of `item` and the knowledge about it; `None` if it has none of the [`FORMS`]. A value out of range
/// is returned, and the caller refuses it; invalid bounds and tolerances count as none of the forms.
pub(super) fn read(spec: &ParameterSpec, item: &Item) -> Option<(f64, Option<Knowledge>)> {
    read_in(item, |value| spec.contains(value), Some(spec))
}

/// Reads the same in another unit, in which `contains` tells whether a bound is in range; `"unknown"` needs a `spec`.
pub(super) fn read_in(
    item: &Item,
    contains: impl Fn(f64) -> bool,
    spec: Option<&ParameterSpec>,
) -> Option<(f64, Option<Knowledge>)> {
    if let Some(value) = number(item) {
        return Some((value, None));
    }
    if item.as_str() == Some(UNKNOWN) {
        return Some((start_of_unknown(spec?), Some(Knowledge::Unknown)));
    }
    let table = item.as_table_like()?;
    if table.iter().any(|(key, _)| !KEYS.contains(&key)) {
        return None;
    }
    let get = |key| match table.get(key) {
        Some(item) => number(item).map(Some),
        None => Some(None),
    };
    let (value, percent, half) = (get(VALUE)?, get(TOLERANCE_PCT)?, get(TOLERANCE)?);
    let range = get(MIN)?.zip(get(MAX)?);
    let stated = [EXACT, TOLERANCE_PCT, TOLERANCE, MIN];
    if stated.iter().filter(|key| table.contains_key(key)).count() > 1 || is_half_range(table) {
        return None;
    }
    let is_width = |width: f64| width >= 0.0 && width.is_finite();
    let knowledge = match (percent, half, range) {
        (Some(percent), ..) if is_width(percent) => Some(Knowledge::TolerancePct(percent)),
        (_, Some(half), _) if is_width(half) => Some(Knowledge::Tolerance(half)),
        (_, _, Some((least, most))) if contains(least) && contains(most) && least < most => {
            Some(Knowledge::Range(least, most))
        }
        (None, None, None) => match table.get(EXACT).map(|item| item.as_bool()) {
            Some(Some(true)) => Some(Knowledge::Exact),
            None => None,
            Some(_) => return None,
        },
        _ => return None,
    };
    match (value, knowledge) {
        (Some(value), Some(Knowledge::Range(least, most))) if !(least..=most).contains(&value) => {
            None
        }
        (Some(value), knowledge) => Some((value, knowledge)),
        (None, Some(Knowledge::Range(least, most))) => {
            Some((middle((least, most)), Some(Knowledge::Range(least, most))))
        }
        (None, _) => None,
    }
}

fn is_half_range(table: &dyn TableLike) -> bool {
    table.contains_key(MIN) != table.contains_key(MAX)
}

/// Returns the value at which a fit of an unknown value begins: that of the shipped plant, otherwise the middle of the
/// range.
fn start_of_unknown(spec: &ParameterSpec) -> f64 {
    let shipped = toml_edit::Document::parse(NOMINAL_PLANT_TOML).ok();
    shipped
        .as_ref()
        .and_then(|document| number(document.get(spec.section)?.get(spec.key)?))
        .or(spec.size.map(|size| size.typical))
        .unwrap_or_else(|| middle(spec.range))
}

/// Returns `value` with its knowledge as TOML.
pub(super) fn write(value: f64, knowledge: Option<Knowledge>) -> String {
    match knowledge {
        None => format!("{value:?}"),
        Some(Knowledge::Exact) => format!("{{ {VALUE} = {value:?}, {EXACT} = true }}"),
        Some(Knowledge::TolerancePct(percent)) => {
            format!("{{ {VALUE} = {value:?}, {TOLERANCE_PCT} = {percent:?} }}")
        }
        Some(Knowledge::Tolerance(half)) => {
            format!("{{ {VALUE} = {value:?}, {TOLERANCE} = {half:?} }}")
        }
        Some(Knowledge::Range(least, most)) => {
            format!("{{ {VALUE} = {value:?}, {MIN} = {least:?}, {MAX} = {most:?} }}")
        }
        Some(Knowledge::Unknown) => format!("\"{UNKNOWN}\""),
    }
}

/// Returns `item` as a number, if it is one.
pub(super) fn number(item: &Item) -> Option<f64> {
    match item.as_value()? {
        Value::Float(value) => Some(*value.value()),
        Value::Integer(value) => Some(*value.value() as f64),
        _ => None,
    }
}
