//! Values that exclude each other.

use super::error::Problem;
use super::values::PlantParameters;

/// What no single range can catch.
pub(super) fn inconsistency(plant: &PlantParameters) -> Option<Problem> {
    let at = |key: &'static str, rule: String| Some(Problem::Inconsistent { key, rule });
    if plant.magnet.gap_closed_m <= plant.armature.stroke_m {
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
