//! Logged supply pressure that drives the plant (E60).

use recording::{Bounds, Quantity, Recording, TimeBase, Unit};

use super::averaging::{Input, averaged};
use crate::parameters::{PA_PER_BAR, ParameterSpec, Part, PlantParameters};
use crate::plant::FILL;

/// Name of the signal.
pub const SUPPLY_PRESSURE: &str = "p_sup";

/// Supply pressure (Pa): a slow one has no second differences.
const PRESSURE: Input = Input {
    differences: &[1.0, -2.0, 1.0],
    least_step: 1.0,
};

/// Returns the lowest and the highest supply pressure (Pa abs) that drives a plant: the lowest pressure that counts as
/// measured, and the highest supply pressure of a plant file.
pub fn supply_bounds(parameters: &PlantParameters) -> (f64, f64) {
    let spec = ParameterSpec::by_name("gas.supply_pressure_bar_gauge");
    let most_bar = spec.map_or(f64::INFINITY, |spec| spec.range.1);
    (
        Bounds::of(Quantity::Pressure).least * PA_PER_BAR,
        most_bar * PA_PER_BAR + parameters.gas.ambient_pressure_pa,
    )
}

/// Returns whether `p_sup` of `log` drives the plant: the plant has a supply, and the signal has a usable value.
///
/// # Errors
/// Returns the reason, a sentence without a full stop, if the log has `p_sup` and it does not drive the plant.
pub fn drives_supply(parameters: &PlantParameters, log: &Recording) -> Result<bool, String> {
    if !log.mentions(SUPPLY_PRESSURE) {
        return Ok(false);
    }
    if !Part::FlowThrough(FILL).is_in(parameters) {
        return Err("the plant has no fill valve that a supply pressure drives".to_owned());
    }
    if let Some(reason) = log.reason_left_out(SUPPLY_PRESSURE) {
        return Err(reason.to_owned());
    }
    let signal = log.require(SUPPLY_PRESSURE, Quantity::Pressure);
    let signal = signal.map_err(|error| error.to_string())?;
    let ambient = parameters.gas.ambient_pressure_pa;
    let values = signal.values_at_ambient(Unit::PascalAbsolute, ambient);
    let values = values.map_err(|error| error.to_string())?;
    let (least, most) = supply_bounds(parameters);
    let is_usable = |value: &f64| (least..=most).contains(value);
    match values.iter().any(is_usable) {
        true => Ok(true),
        false => Err(format!(
            "no sample lies between {:.3} and {:.1} bar absolute; look at its unit",
            least / PA_PER_BAR,
            most / PA_PER_BAR
        )),
    }
}

/// Returns the supply pressure (Pa abs) at the rows of `base`, NaN if the last one stays valid: the reading of the
/// gauge, averaged according to its noise. `None` if the log has none that drives the plant.
pub(super) fn logged_supply(
    parameters: &PlantParameters,
    log: &Recording,
    base: &TimeBase,
) -> Option<Vec<f64>> {
    if !drives_supply(parameters, log).unwrap_or(false) {
        return None;
    }
    let signal = log.signal(SUPPLY_PRESSURE)?;
    let own = log.time_base(signal.time_base())?;
    let ambient = parameters.gas.ambient_pressure_pa;
    let values = signal.values_at_ambient(Unit::PascalAbsolute, ambient);
    let mut values = values.ok()?;
    let (least, most) = supply_bounds(parameters);
    for value in &mut values {
        if !(least..=most).contains(value) {
            *value = f64::NAN;
        }
    }
    let values = averaged(&values, &PRESSURE);
    if own == base {
        return Some(values);
    }
    let places = last_before(own, base).into_iter();
    Some(
        places
            .map(|place| place.map_or(f64::NAN, |place| values[place]))
            .collect(),
    )
}

/// Returns for each row of `base` the last sample of a signal on the time base `own`, which is valid until the next
/// one; `None` before the first.
pub(super) fn last_before(own: &TimeBase, base: &TimeBase) -> Vec<Option<usize>> {
    let before = |time_s: &f64| own.times_s().partition_point(|own_s| own_s <= time_s);
    let rows = base.times_s().iter();
    rows.map(|time_s| before(time_s).checked_sub(1)).collect()
}
