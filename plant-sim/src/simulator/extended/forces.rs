//! Forces on an armature with effects.

use super::super::gas;
use super::Extended;
use crate::hooks::{self, Now};
use crate::valve::ValveState;

/// State of an armature in a stage of a step.
#[derive(Clone, Copy)]
pub(super) struct ArmatureNow {
    /// Index of its valve.
    pub(super) index: usize,
    /// Lift (m).
    pub(super) x: f64,
    /// Velocity (m/s).
    pub(super) v: f64,
}

impl Extended {
    /// Returns the forces on an armature without friction (N).
    #[inline]
    pub(super) fn net_force(
        &self,
        armature: ArmatureNow,
        pulling_current: f64,
        pressure_drop: f64,
        now: Option<&Now>,
    ) -> f64 {
        let ArmatureNow { index, x, v } = armature;
        let valve = &self.plant.valves[index];
        let additions = &self.plant.additions;
        let drop = if additions.flow_force.at_full_lift == 0.0 {
            pressure_drop
        } else {
            let lift = valve.lift(x) / valve.armature.stroke;
            pressure_drop * (1.0 - additions.flow_force.lost_share(lift))
        };
        let own = now.map_or(0.0, |now| hooks::sum(&additions.hooks.force[index], now));
        valve.magnet.force(pulling_current, x) + valve.armature.static_force(x, drop)
            - valve.armature.viscous_friction * v
            + own
    }

    /// Returns the net force on an armature that does not move (N).
    pub(super) fn resting_force(
        &self,
        index: usize,
        valve: &ValveState,
        current: f64,
        pressure: f64,
        extra: &[f64],
    ) -> f64 {
        let mut currents = [0.0; 2];
        currents[index] = current;
        let now = self.now(pressure, extra, (currents, [valve.x; 2], [0.0; 2]));
        let area = self.plant.valves[index].effective_area(valve.x);
        let opening = gas::Opening { valve: index, area };
        let drop = gas::pressure_drop(
            &self.plant,
            &self.layout,
            opening,
            pressure,
            extra,
            now.as_ref(),
        );
        let armature = ArmatureNow {
            index,
            x: valve.x,
            v: 0.0,
        };
        self.net_force(armature, current, drop, now.as_ref())
    }
}
