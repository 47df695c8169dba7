//! Which way leads from a fault into the safe state.

use crate::fault::{Fault, FaultSet};

/// A way into the safe state, the stricter the later. `docs/safety.md` has the reason for each fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Way {
    /// Shut both valves and see whether the fault passes; then release.
    Hold,
    /// Lead the reference down to zero with the vent valve, then empty the chamber.
    Ramp,
    /// Empty the chamber in pulses, without the sensor.
    Release,
    /// Empty the chamber at once.
    Vent,
    /// Both coils off at once.
    Off,
    /// Both coils off until somebody releases it.
    Lock,
}

const HELD: FaultSet = FaultSet::from_faults(&[
    Fault::SensorOpen,
    Fault::SensorShort,
    Fault::SensorBelowRange,
    Fault::SensorAboveRange,
    Fault::SensorJump,
    Fault::SensorMissing,
    Fault::BatteryLow,
    Fault::BatteryHigh,
]);
const RAMPED: FaultSet = FaultSet::from_faults(&[
    Fault::NoRise,
    Fault::UncommandedFall,
    Fault::SupplyLost,
    Fault::FillCoilOpen,
    Fault::ReferenceLost,
]);
const RELEASED: FaultSet = FaultSet::from_faults(&[Fault::SensorStuck, Fault::SampleTime]);
const VENTED: FaultSet = FaultSet::from_faults(&[
    Fault::SensorOffset,
    Fault::NoFall,
    Fault::UncommandedRise,
    Fault::FillCoilShort,
]);
const SWITCHED_OFF: FaultSet = FaultSet::from_faults(&[Fault::VentCoilOpen, Fault::VentCoilShort]);
const LOCKED: FaultSet = FaultSet::from_faults(&[Fault::MemoryDamaged]);

impl Way {
    /// The strictest way of these faults; none for none. Without a sensor there is no ramp: held and ramped together release.
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
    fn each_fault_has_exactly_one_way() {
        for fault in Fault::ALL {
            let ways = [HELD, RAMPED, RELEASED, VENTED, SWITCHED_OFF, LOCKED];
            let its = ways.iter().filter(|faults| faults.contains(fault));
            assert_eq!(its.count(), 1, "{fault:?}");
        }
    }

    #[test]
    fn the_stricter_of_two_faults_decides() {
        for first in Fault::ALL {
            for second in Fault::ALL {
                let both = FaultSet::of(first).union(FaultSet::of(second));
                let (one, other) = (Way::of(FaultSet::of(first)), Way::of(FaultSet::of(second)));
                let expected = match (one.min(other), one.max(other)) {
                    (Some(Way::Hold), Some(Way::Ramp)) => Some(Way::Release),
                    (_, stricter) => stricter,
                };
                assert_eq!(Way::of(both), expected, "{first:?} and {second:?}");
            }
        }
        assert_eq!(Way::of(FaultSet::NONE), None);
    }
}
