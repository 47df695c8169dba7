//! Step of the solver as functions of time.
//!
//! The state contains the pressure, then current, position and velocity of each of the `M` live valves, then the states
//! of effects. With effects the flux linkage is in the place of the current. Within a step, position has both
//! derivatives at both ends and is a quintic; the others are cubics. Both are more accurate than the step itself, so an
//! event needs no second step up to it.

use crate::solver::hermite::{Cubic, Quintic};

/// Step from `start` to `end` over `h` (s), with the rates at both ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span<const N: usize, const M: usize> {
    pub(super) h: f64,
    pub(super) start: [f64; N],
    pub(super) start_rate: [f64; N],
    pub(super) end: [f64; N],
    pub(super) end_rate: [f64; N],
}

/// Returns the index of the current of the live valve in `slot`; position and velocity follow.
#[inline]
pub(super) fn first_of(slot: usize) -> usize {
    1 + 3 * slot
}

impl<const N: usize, const M: usize> Span<N, M> {
    pub(super) fn cubic(&self, n: usize) -> Cubic {
        Cubic::new(
            self.h,
            self.start[n],
            self.start_rate[n],
            self.end[n],
            self.end_rate[n],
        )
    }

    /// Returns the chamber pressure over time.
    pub(super) fn pressure(&self) -> Cubic {
        self.cubic(0)
    }

    /// Returns the current of the moving valve in `slot` over time.
    pub(super) fn current(&self, slot: usize) -> Cubic {
        self.cubic(first_of(slot))
    }

    /// Returns the position of the moving valve in `slot` over time.
    pub(super) fn position(&self, slot: usize) -> Quintic {
        let x = first_of(slot) + 1;
        Quintic::new(
            self.h,
            [self.start[x], self.start[x + 1], self.start_rate[x + 1]],
            [self.end[x], self.end[x + 1], self.end_rate[x + 1]],
        )
    }

    /// Returns the state at `time` within the step.
    pub(super) fn at(&self, time: f64) -> [f64; N] {
        if time >= self.h {
            return self.end;
        }
        let mut state = [0.0; N];
        state[0] = self.pressure().at(time);
        for slot in 0..M {
            let position = self.position(slot);
            let values = [
                self.current(slot).at(time),
                position.at(time),
                position.rate_at(time),
            ];
            state[first_of(slot)..first_of(slot + 1)].copy_from_slice(&values);
        }
        for (n, value) in state.iter_mut().enumerate().skip(first_of(M)) {
            *value = self.cubic(n).at(time);
        }
        state
    }
}
