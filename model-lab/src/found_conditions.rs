//! Comparison of a log under the conditions found from the log and the model.

use plant_sim::PlantParameters;
use recording::Recording;

use crate::compare::compare_under;
use crate::conditions::LogConditions;
use crate::diagnosis::conditions_of;
use crate::error::CompareError;
use crate::options::CompareOptions;
use crate::result::Comparison;

/// Finds the conditions under which `log` was made, with an unchanged `plant`: the clock of its logger, the instants at which commands were
/// given, and the temperature of the gas when the log begins with a filled chamber. Of a long log, the
/// [beginning](LogConditions::is_in_beginning) is searched.
///
/// A log that cannot be compared, or whose clock cannot be determined, counts as recorded by the ECU itself.
#[must_use]
pub fn find_conditions(plant: &PlantParameters, log: &Recording) -> LogConditions {
    conditions_of(plant, log, &|| true).unwrap_or_default()
}

/// Compares the model with `parameters` with `log`, as [`compare_under`] the conditions that [`find_conditions`] finds.
///
/// # Errors
/// [`CompareError`]: the log cannot drive the model, has no signal of the model, or an option is out of range.
pub fn compare(
    parameters: &PlantParameters,
    log: &Recording,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    compare_watched(parameters, log, options, &|_| true)
}

/// Compares as [`compare`] does, with progress: calls `goes_on` every few milliseconds with the share of the work that is done (0 to 1); a
/// return value of false stops the comparison. While the conditions are sought, it is called a few times with 0.
///
/// # Errors
/// Those of [`compare`], and [`CompareError::Stopped`].
pub fn compare_watched(
    parameters: &PlantParameters,
    log: &Recording,
    options: &CompareOptions,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Comparison, CompareError> {
    options.check()?;
    let conditions = conditions_of(parameters, log, &|| goes_on(0.0));
    if conditions.is_none() && !goes_on(0.0) {
        return Err(CompareError::Stopped);
    }
    let conditions = conditions.unwrap_or_default();
    compare_under(parameters, log, &conditions, options, goes_on)
}
