//! Fault reactions: how the ECU reaches the safe state.

use crate::fault::{Fault, FaultSet};

/// Fault reaction, in order of increasing strictness. `docs/safety.md` has the reason for each fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum FaultReaction {
    /// Shut both valves and wait whether the fault passes; then release.
    Hold = 0,
    /// Ramp the reference down to zero with the vent valve, then empty the chamber.
    Ramp = 1,
    /// Empty the chamber in pulses, without the sensor.
    Release = 2,
    /// Empty the chamber at once.
    Vent = 3,
    /// Switch both coils off at once.
    Off = 4,
    /// Switch both coils off until the lock is released.
    Lock = 5,
}

impl Fault {
    /// Returns the reaction to the fault.
    pub const fn reaction(self) -> FaultReaction {
        match self {
            Self::SensorOpen
            | Self::SensorShort
            | Self::SensorBelowRange
            | Self::SensorAboveRange
            | Self::SensorJump
            | Self::SensorMissing
            | Self::BatteryLow
            | Self::BatteryHigh => FaultReaction::Hold,
            Self::NoRise
            | Self::UncommandedFall
            | Self::SupplyLost
            | Self::FillCoilOpen
            | Self::ReferenceLost => FaultReaction::Ramp,
            Self::SensorStuck | Self::SampleTime => FaultReaction::Release,
            Self::SensorOffset | Self::NoFall | Self::UncommandedRise | Self::FillCoilShort => {
                FaultReaction::Vent
            }
            Self::VentCoilOpen | Self::VentCoilShort => FaultReaction::Off,
            Self::MemoryDamaged => FaultReaction::Lock,
        }
    }
}

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
