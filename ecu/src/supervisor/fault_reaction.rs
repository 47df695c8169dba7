//! Reaction to several faults at once.

use crate::fault::{Fault, FaultReaction, FaultSet};

const HELD: FaultSet = taking(FaultReaction::Hold);
const RAMPED: FaultSet = taking(FaultReaction::Ramp);
const RELEASED: FaultSet = taking(FaultReaction::Release);
const VENTED: FaultSet = taking(FaultReaction::Vent);
const SWITCHED_OFF: FaultSet = taking(FaultReaction::Off);
const LOCKED: FaultSet = taking(FaultReaction::Lock);

/// Returns the faults with this reaction.
const fn taking(reaction: FaultReaction) -> FaultSet {
    let mut set = FaultSet::NONE;
    let mut faults: &[Fault] = &Fault::ALL;
    while let [fault, rest @ ..] = faults {
        set = set.union(FaultSet::when(
            fault.reaction() as u8 == reaction as u8,
            *fault,
        ));
        faults = rest;
    }
    set
}

impl FaultReaction {
    /// Returns the strictest reaction to these faults, or `None` without a fault. A ramp needs the sensor: `Hold` and
    /// `Ramp` together give `Release`.
    #[inline(always)]
    pub(crate) const fn of(faults: FaultSet) -> Option<Self> {
        let is_ramped = faults.has_any_of(RAMPED);
        let is_held = faults.has_any_of(HELD);
        if faults.has_any_of(LOCKED) {
            Some(Self::Lock)
        } else if faults.has_any_of(SWITCHED_OFF) {
            Some(Self::Off)
        } else if faults.has_any_of(VENTED) {
            Some(Self::Vent)
        } else if faults.has_any_of(RELEASED) || is_ramped && is_held {
            Some(Self::Release)
        } else if is_ramped {
            Some(Self::Ramp)
        } else if is_held {
            Some(Self::Hold)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stricter_of_two_faults_decides() {
        for first in Fault::ALL {
            for second in Fault::ALL {
                let both = FaultSet::of(first).union(FaultSet::of(second));
                let (one, other) = (
                    FaultReaction::of(FaultSet::of(first)),
                    FaultReaction::of(FaultSet::of(second)),
                );
                let expected = match (one.min(other), one.max(other)) {
                    (Some(FaultReaction::Hold), Some(FaultReaction::Ramp)) => {
                        Some(FaultReaction::Release)
                    }
                    (_, stricter) => stricter,
                };
                assert_eq!(
                    FaultReaction::of(both),
                    expected,
                    "{first:?} and {second:?}"
                );
            }
        }
        assert_eq!(FaultReaction::of(FaultSet::NONE), None);
    }
}
