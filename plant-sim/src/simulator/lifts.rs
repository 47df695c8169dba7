//! Counter of the lifts of a valve from its seat.

use super::span::{Span, first_of};
use crate::solver::root::first_positive;
use crate::valve::Valve;

/// Height that a departure from the seat must reach to count as a lift, as a share of the stroke (assumed): an armature
/// that trembles on its seat by less does not wear it.
const COUNTED_FROM: f64 = 0.01;

/// Lifts of one valve: departures from its seat, of which each bounce is one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lifts {
    count: u64,
    /// Whether the present departure was counted; a valve that starts open has left its seat before.
    is_counted: bool,
}

impl Lifts {
    /// Creates the counter of `valve` at its rest stop.
    pub(super) fn at_rest(valve: &Valve) -> Self {
        Self {
            count: 0,
            is_counted: valve.lift(0.0) > 0.0,
        }
    }

    pub(super) fn count(self) -> u64 {
        self.count
    }

    /// Counts the present departure of `valve`, the live one in `slot`, if it is high enough in the first `taken` (s) of a
    /// step. An armature that rises and falls back within them is judged by its turning point.
    #[inline]
    pub(super) fn follow<const N: usize, const M: usize>(
        &mut self,
        valve: &Valve,
        span: &Span<N, M>,
        slot: usize,
        taken: f64,
        end: &[f64; N],
    ) {
        if self.is_counted {
            return;
        }
        let [position, velocity] = [1, 2].map(|offset| first_of(slot) + offset);
        let opening = (valve.lift(1.0) - valve.lift(0.0)).signum();
        let is_falling_back = opening * span.start[velocity] > 0.0 && opening * end[velocity] < 0.0;
        let highest = if is_falling_back {
            let x = span.position(slot);
            let turn = first_positive(|t| -opening * x.rate_at(t), 0.0, taken);
            valve.lift(x.at(turn))
        } else {
            valve.lift(end[position])
        };
        if highest >= COUNTED_FROM * valve.armature.stroke {
            self.is_counted = true;
            self.count += 1;
        }
    }

    /// Ends the present departure: the armature is on the seat.
    pub(super) fn land(&mut self) {
        self.is_counted = false;
    }
}
