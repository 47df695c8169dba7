//! Ordinary parameters that a refit changed. Each can be switched between its refitted value and the one as opened.

use plant_sim::PlantParameters;
use serde::Serialize;

use crate::history::History;
use crate::refusal::Refusal;

/// Ordinary parameter with its values before and after the refit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct RefittedParameter {
    pub(super) name: String,
    pub(super) unit: &'static str,
    about: &'static str,
    /// Value of the plant as opened.
    pub(super) before: f64,
    /// Value of the last refit up to the current step.
    pub(super) after: f64,
    /// Whether the current plant has the refitted value.
    is_refitted: bool,
}

/// Returns the ordinary parameters that a step up to the current one changed, in the order of the plant file.
pub(super) fn refitted(history: &History) -> Result<Vec<RefittedParameter>, Refusal> {
    let until_now = history.steps()[..=history.at()].iter();
    let plants: Vec<PlantParameters> = until_now
        .map(|step| step.plant.parameters())
        .collect::<Result<_, _>>()?;
    let (Some(opened), Some(now)) = (plants.first(), plants.last()) else {
        return Ok(Vec::new());
    };
    let ordinary = opened.specs().filter(|spec| spec.effect_id().is_none());
    let changed = ordinary.filter_map(|spec| {
        let before = spec.value(opened)?;
        let values = plants.iter().rev().filter_map(|plant| spec.value(plant));
        let after = values.into_iter().find(|value| *value != before)?;
        Some(RefittedParameter {
            name: spec.name(),
            unit: spec.unit,
            about: spec.about,
            before,
            after,
            is_refitted: spec.value(now) == Some(after),
        })
    });
    Ok(changed.collect())
}
