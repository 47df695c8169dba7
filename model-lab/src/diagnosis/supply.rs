//! Was the supply shut off while a log was made?

use plant_sim::PlantParameters;
use plant_sim::effects::{EffectSetting, LIBRARY};

use super::evidence::Evidence;
use super::search::shows_in_currents;
use super::trial::Bench;

/// A log of this length at most (s) is worth a search over the effects of the coils for each answer.
const SHORT_S: f64 = 5.0;

/// Coil currents are often recorded with the supply shut off, and no column tells. Of the one log in `evidence`, if it
/// has no chamber pressure: takes the answer with which the model, its scatter fitted, comes nearer.
pub(crate) fn find_supply(plant: &PlantParameters, evidence: &mut Evidence) {
    let has_coil = plant.functions.iter().any(|function| function.has_coil());
    if evidence.has_pressure() || !has_coil {
        return;
    }
    let with_supply = least_cost(plant, evidence);
    evidence.logs[0].is_without_supply = true;
    evidence.logs[0].is_without_supply = least_cost(plant, evidence) < with_supply;
}

/// Of the plain plant, and in a short log, with any effect that shows in currents.
fn least_cost(plant: &PlantParameters, evidence: &Evidence) -> f64 {
    let bench = Bench {
        plant,
        library: &LIBRARY,
        fitting: evidence,
        checking: evidence,
    };
    let Some(plain) = bench.plain() else {
        return f64::INFINITY;
    };
    let effects = LIBRARY
        .into_iter()
        .filter(|&effect| shows_in_currents(effect) && evidence.duration_s() <= SHORT_S);
    effects
        .filter_map(|effect| bench.begin(&plain, EffectSetting::typical(effect)))
        .map(|opened| opened.fit.cost)
        .fold(plain.fit.cost, f64::min)
}
