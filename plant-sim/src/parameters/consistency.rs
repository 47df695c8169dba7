//! Checks for values that exclude each other.

use super::error::Problem;
use super::parts::Part;
use crate::description::PlantParameters;
use crate::effects::by_id;

/// Returns a problem that no single range can detect.
pub(super) fn inconsistency(plant: &PlantParameters) -> Option<Problem> {
    let at = |key: &'static str, rule: String| Some(Problem::Inconsistent { key, rule });
    if !Part::Coil.is_in(plant) && !Part::Chamber.is_in(plant) {
        return at(
            "valves",
            "nothing is left to simulate without a valve or a chamber".to_owned(),
        );
    }
    for setting in &plant.effects {
        let part = Part::of_effect(setting.effect());
        // The part of an effect in Rust outside of the library is not known.
        let is_known =
            by_id(setting.id()).is_some() || setting.effect().definition_toml().is_some();
        if is_known && !part.is_in(plant) {
            let effect = setting.effect().about();
            return Some(Problem::NothingToActOn { effect, part });
        }
    }
    if Part::Armature.is_in(plant) && plant.magnet.gap_closed_m <= plant.armature.stroke_m {
        return at(
            "magnet.gap_closed_m",
            format!(
                "the effective gap {} m must be larger than armature.stroke_m = {} m, else the magnetic force is infinite",
                plant.magnet.gap_closed_m, plant.armature.stroke_m
            ),
        );
    }
    if let Some(valve) = &plant.regulating_valve
        && valve.dynamic_friction_n > valve.static_friction_n
    {
        return at(
            "regulating_valve.dynamic_friction_n",
            format!(
                "friction in motion, {} N, cannot exceed friction at rest, static_friction_n = {} N",
                valve.dynamic_friction_n, valve.static_friction_n
            ),
        );
    }
    None
}
