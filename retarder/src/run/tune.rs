//! Controller file for a plant: duty limits by experiment on the model, its nominal values, and gains.

use controller::Settings;
use hil_harness::Scenario;
use hil_harness::controller_file::{self, Key};
use hil_harness::duty_limits::with_duty_limits;
use hil_harness::gain_search::{Found, Search, SearchError, StartingPoint, search};
use hil_harness::reference_profile::ReferenceProfile;
use hil_harness::supervision::with_nominal_values;

use crate::failure::Failure;
use crate::input::{NamedController, NamedPlant, NamedRequirement};
use crate::progress::Progress;

/// Plant, controller, and where its gains come from.
pub(crate) struct Task {
    pub(crate) plant: NamedPlant,
    pub(crate) controller: NamedController,
    pub(crate) requirements: NamedRequirement,
    pub(crate) gains: Gains,
}

/// Source of the gains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Gains {
    /// Those of the controller that is tuned.
    Kept,
    /// An experiment on the model.
    Started(StartingPoint),
    /// A search on scattered rigs.
    Searched(Search),
}

/// Controller file for a plant.
pub(crate) struct Tuned {
    /// Controller file.
    pub(crate) text: String,
    pub(crate) task: Task,
    /// `None` if the gains were not searched.
    pub(crate) searched: Option<Searched>,
}

/// Search and its result.
pub(crate) struct Searched {
    pub(crate) search: Search,
    pub(crate) found: Found,
}

/// Returns the file of the controller with the values that belong to the plant. Each changed value says so in its
/// comment.
pub(crate) fn run(task: Task) -> Result<Tuned, Failure> {
    let plant = &task.plant;
    let nominal = with_nominal_values(task.controller.settings, &plant.parameters);
    let limited =
        with_duty_limits(nominal, &plant.parameters).map_err(|error| Failure::NotTuned {
            plant: plant.name.clone(),
            error,
        })?;
    let requirement = &task.requirements.requirement;
    let scenario = Scenario {
        controller: limited,
        ..Scenario::new("tuning", ReferenceProfile::starting_at(0.0)).on(plant.parameters.clone())
    };
    let refused = |error: SearchError| Failure::NoGains {
        controller: task.controller.name.clone(),
        plant: plant.name.clone(),
        error: Box::new(error),
    };
    let (tuned, how, searched) = match task.gains {
        Gains::Kept => (limited, String::new(), None),
        Gains::Started(method) => {
            let tuned = method
                .gains(&scenario, requirement)
                .map_err(|error| refused(error.into()))?;
            (tuned, format!(" --gains {}", method.name()), None)
        }
        Gains::Searched(extent) => {
            let progress = Progress::of_count("candidates", extent.candidates.into());
            let found =
                search(&scenario, requirement, extent, &mut || progress.step()).map_err(refused)?;
            let choose = extent.choose;
            let choose = choose.map_or(String::new(), |number| format!(" --choose {number}"));
            let how = format!(
                " --search {} --rigs {} --seed {}{choose}",
                extent.candidates, extent.rigs, extent.seed
            );
            let tuned = found.chosen().settings;
            let searched = Searched {
                search: extent,
                found,
            };
            (tuned, how, Some(searched))
        }
    };
    let origin = format!("`retarder tune{how}`, {}", plant.name);
    Ok(Tuned {
        text: with_values_of(&task.controller, &tuned, &origin),
        searched,
        task,
    })
}

/// Returns the file of `controller` with the values of `tuned`, each changed one with `origin` as its comment.
fn with_values_of(controller: &NamedController, tuned: &Settings, origin: &str) -> String {
    let text = controller_file::write(tuned);
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
    controller_file::with_values(&controller.text, &changes, origin)
}
