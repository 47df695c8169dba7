//! Controller file for a plant: duty limits by experiment on the model, and its nominal values.

use hil_harness::controller_file::{self, Key};
use hil_harness::duty_limits::with_duty_limits;
use hil_harness::supervision::with_nominal_values;

use crate::failure::Failure;
use crate::input::{NamedController, NamedPlant};

/// Returns the file of `controller` with the values that belong to `plant`. Each changed value says so in its comment.
pub(crate) fn run(plant: &NamedPlant, controller: &NamedController) -> Result<String, Failure> {
    let nominal = with_nominal_values(controller.settings, &plant.parameters);
    let tuned =
        with_duty_limits(nominal, &plant.parameters).map_err(|error| Failure::NotTuned {
            plant: plant.name.clone(),
            error,
        })?;
    let text = controller_file::write(&tuned);
    let found = controller_file::values(&text);
    let before = controller_file::values(&controller_file::write(&controller.settings));
    let value_before = |key: &Key| before.iter().find(|(other, _)| other.path() == key.path());
    let changed = found
        .iter()
        .filter(|(key, value)| value_before(key).is_none_or(|(_, before)| before != value))
        .map(|(key, value)| (*key, Some(value.as_str())));
    let dropped = before
        .iter()
        .filter(|(key, _)| found.iter().all(|(other, _)| other.path() != key.path()))
        .map(|(key, _)| (*key, None));
    let changes: Vec<_> = changed.chain(dropped).collect();
    let origin = format!("`retarder tune`, {}", plant.name);
    Ok(controller_file::with_values(
        &controller.text,
        &changes,
        &origin,
    ))
}
