//! What is fixed between two events, where the right-hand side is smooth.

use crate::coil::Drive;
use crate::orifice::Limit;

/// `M` valves are live, the others rest.
#[derive(Debug)]
pub(super) struct Smooth<const M: usize> {
    /// The valves in the slots of the state.
    pub(super) live: [usize; M],
    pub(super) drives: [Drive; M],
    /// Which part of the area law the step stays on.
    pub(super) limits: [Limit; M],
    /// Direction of motion of each: 0 where the armature rests.
    pub(super) directions: [f64; M],
    /// Effective areas (m²) of the valves as they rest.
    pub(super) resting_areas: [f64; 2],
    /// Positions (m) of the valves as they rest.
    pub(super) resting_positions: [f64; 2],
}

impl<const M: usize> Smooth<M> {
    /// The slot of a valve; none where it is not live.
    pub(super) fn slot_of(&self, index: usize) -> Option<usize> {
        self.live.iter().position(|live| *live == index)
    }
}
