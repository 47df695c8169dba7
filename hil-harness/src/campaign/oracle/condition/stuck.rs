//! Detection of a sensor that shows the same code while valves move the pressure.

use super::rig::Rig;
use crate::campaign::bounds;
use crate::campaign::oracle::Observation;
use crate::campaign::oracle::memory::Memory;

/// One code for N samples in which a valve was driven and had a pressure to move.
#[derive(Debug, Default)]
pub(super) struct Stuck {
    code: Option<u16>,
    unmoved: u32,
}

impl Stuck {
    pub(super) fn look(&mut self, rig: &Rig, observation: &Observation, memory: &Memory) -> bool {
        let [fill, vent] = memory.coils().unwrap_or_default();
        let is_driven = observation.shown_bar().is_some_and(|shown| {
            fill > 0.0 && shown < rig.supply_min_bar - 0.01
                || vent > 0.0 && shown > bounds::ROOM_TO_FALL_BAR
        });
        if observation.sensors.pressure.is_none() || observation.sensors.pressure != self.code {
            self.code = observation.sensors.pressure;
            self.unmoved = 0;
        } else if is_driven {
            self.unmoved += 1;
        }
        self.unmoved >= bounds::STUCK_N
    }
}
