//! Data that is constant between two events, where the right-hand side is smooth.

use crate::coil::Drive;
use crate::orifice::Limit;

/// Constant data of an interval with `M` live valves; the others rest.
#[derive(Debug)]
pub(super) struct Smooth<const M: usize> {
    /// Valves in the slots of the state.
    pub(super) live: [usize; M],
    pub(super) drives: [Drive; M],
    /// Part of the area law on which the step stays.
    pub(super) limits: [Limit; M],
    /// Direction of motion of each valve: 0 if the armature rests.
    pub(super) directions: [f64; M],
    /// Effective areas (m²) of the valves at rest.
    pub(super) resting_areas: [f64; 2],
    /// Positions (m) of the valves at rest.
    pub(super) resting_positions: [f64; 2],
}

impl<const M: usize> Smooth<M> {
    /// Returns the slot of a valve; `None` if it is not live.
    pub(super) fn slot_of(&self, index: usize) -> Option<usize> {
        self.live.iter().position(|live| *live == index)
    }
}
