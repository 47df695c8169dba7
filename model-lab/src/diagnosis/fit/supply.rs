//! Test whether the supply was shut off while a log was made.

use plant_sim::PlantParameters;
use plant_sim::effects::{Effect, EffectSetting, EntryPoint};

use super::trial::Bench;
use crate::diagnosis::evidence::Evidence;

/// Longest log (s) that justifies a search over the effects of the coils for each hypothesis.
const SHORT_S: f64 = 5.0;

/// Determines whether the supply was shut off: coil currents are often recorded that way, and no column shows it. For the one log in
/// `evidence`, if it has no chamber pressure, the hypothesis with the smaller cost of the fitted model is taken.
pub(crate) fn find_supply(plant: &PlantParameters, evidence: &mut Evidence) {
    let has_coil = plant.functions.iter().any(|function| function.has_coil());
    if evidence.has_pressure() || !has_coil {
        return;
    }
    let with_supply = least_cost(plant, evidence);
    evidence.logs[0].is_without_supply = true;
    evidence.logs[0].is_without_supply = least_cost(plant, evidence) < with_supply;
}

/// Returns the least cost of the plain plant, and in a short log, of the plant with any effect that shows in currents.
fn least_cost(plant: &PlantParameters, evidence: &Evidence) -> f64 {
    let bench = Bench {
        plant,
        library: &[],
        fitting: evidence,
        checking: evidence,
    };
    let Some(plain) = bench.plain() else {
        return f64::INFINITY;
    };
    let effects = plant
        .candidates()
        .filter(|&effect| shows_in_currents(effect) && evidence.duration_s() <= SHORT_S);
    effects
        .filter_map(|effect| bench.begin(&plain, EffectSetting::typical(effect)))
        .map(|opened| opened.fit.cost)
        .fold(plain.fit.cost, f64::min)
}

/// Returns whether coil currents show an effect without the pressure.
pub(crate) fn shows_in_currents(effect: &dyn Effect) -> bool {
    matches!(
        effect.about().acts_on,
        EntryPoint::Coil | EntryPoint::Armature | EntryPoint::ElectricSupply
    )
}
