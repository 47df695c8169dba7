//! State of coils and battery.

use super::rig::Rig;
use crate::campaign::bounds;
use crate::campaign::oracle::Observation;
use crate::campaign::oracle::memory::Memory;

/// Returns whether the coil of this valve, with this current, is open, and whether it is short.
pub(super) fn coil(rig: &Rig, valve: usize, current_ma: Option<u16>, memory: &Memory) -> [bool; 2] {
    let Some(current_ma) = current_ma.map(f64::from) else {
        return [false; 2];
    };
    let [min_ma, max_ma] = rig.coil_ma;
    let is_energised = memory.coil_settled(valve, |duty| duty >= bounds::ENERGISED_PCT);
    let is_off = memory.coil_settled(valve, |duty| duty == 0.0);
    // One milliampere for rounding on the wire.
    [
        is_energised && current_ma < min_ma - 1.0,
        current_ma > max_ma + 1.0 || is_off && current_ma > min_ma + 1.0,
    ]
}

/// Returns whether the battery is outside its window.
pub(super) fn battery(rig: &Rig, observation: &Observation) -> bool {
    let [min_mv, max_mv] = rig.battery_mv;
    let is_outside = |mv: f64| mv < min_mv - 1.0 || mv > max_mv + 1.0;
    observation
        .sensors
        .battery_mv
        .map(f64::from)
        .is_some_and(is_outside)
}
