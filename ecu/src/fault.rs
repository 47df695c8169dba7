//! Faults: one table with their rules and reactions, and sets of them.

use core::fmt;

/// Fault reaction, in order of increasing strictness.
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

/// Defines the faults. A row has the number of the fault, N, the reaction, the rule and the reason for the reaction.
macro_rules! faults {
    ($($id:ident = $number:literal: $samples:literal, $reaction:ident, $rule:literal, $why:literal;)*) => {
        /// Fault, named by its observation: one pressure sensor cannot distinguish a valve that stays shut from a lost
        /// supply.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[repr(u8)]
        pub enum Fault {
            $(#[doc = concat!("Rule: ", $rule, ".")] $id = $number,)*
        }

        impl Fault {
            /// All faults, in the order of their bits.
            pub const ALL: [Self; [$(Self::$id),*].len()] = [$(Self::$id),*];

            /// Returns N, the number of samples that look wrong before the fault is confirmed: N in a row, or N more
            /// wrong than right ones.
            ///
            /// For [`Fault::SensorStuck`] only samples with a driven valve count, for [`Fault::SensorOffset`] only
            /// samples with the vent valve open. For a coil N counts PWM periods.
            pub const fn samples(self) -> u8 {
                match self {
                    $(Self::$id => $samples,)*
                }
            }

            /// Returns the reaction to the fault.
            pub const fn reaction(self) -> FaultReaction {
                match self {
                    $(Self::$id => FaultReaction::$reaction,)*
                }
            }

            /// Returns the rule by which the fault is detected.
            pub const fn rule(self) -> &'static str {
                match self {
                    $(Self::$id => $rule,)*
                }
            }

            /// Returns the reason for the reaction.
            pub const fn why(self) -> &'static str {
                match self {
                    $(Self::$id => $why,)*
                }
            }
        }
    };
}

// `docs/safety.md` is written from this table. CONTRIBUTING.md has the steps of a new fault.
faults! {
    SensorOpen = 0: 5, Hold, "code at most 12 of 4095: wire open, or short to ground",
        "a plug that makes contact again within half a second causes no loss of torque; without a sensor the pressure cannot be ramped, but it can be vented slowly";
    SensorShort = 1: 5, Hold, "code at least 4084: short to the supply",
        "the same";
    SensorBelowRange = 2: 5, Hold, "code below 32: 80 mbar below the sensor's span",
        "the same";
    SensorAboveRange = 3: 5, Hold, "more than `supply_pressure_max_bar` and 0.2 bar: no chamber is above its supply",
        "the same";
    SensorJump = 4: 5, Hold, "changed by more than twice what the faster valve can do in a sample, compared with the last plausible pressure",
        "the same; a pressure that stays at its new value is accepted again, and the model of the valve commands checks it from then on";
    SensorMissing = 5: 5, Hold, "the converter gave no code",
        "the same";
    SensorStuck = 6: 50, Release, "the same code, bit for bit, in N samples in which a valve was driven and had a pressure to move",
        "the fault does not disappear by itself, and a ramp needs a valid pressure";
    SensorOffset = 7: 200, Vent, "more than 0.2 bar after N samples with the vent valve open and the fill valve shut",
        "the chamber was commanded empty; either it is not, or its pressure is unknown";
    NoRise = 8: 3, Ramp, "filled for sure, and 0.5 bar behind the least that the open valve makes: fill valve stuck closed, supply lost, vent valve stuck open",
        "torque cannot be built up; the remaining torque decreases within a second instead of at once";
    NoFall = 9: 3, Vent, "vented for sure, and 0.5 bar above the most that the open valve leaves: vent valve stuck closed, fill valve stuck open",
        "torque does not decrease; the open vent valve releases what still passes it";
    UncommandedRise = 10: 3, Vent, "rose by 0.5 bar with the fill valve shut: fill valve stuck open, sensor drifting up",
        "torque that was not requested";
    UncommandedFall = 11: 3, Ramp, "fell by 0.5 bar with the vent valve shut: vent valve stuck open, leak, sensor drifting down",
        "torque is already decreasing; the rest is reduced slowly";
    SupplyLost = 12: 3, Ramp, "as `NoRise`, and the pressure falls while filled: it flows back into the supply",
        "shut valves would keep the remaining pressure; a ramp makes the driver notice the loss";
    FillCoilOpen = 13: 3, Ramp, "driven by 20 % or more, settled, and less current than `coil_current_min_ma`",
        "the spring shuts the valve; the remaining pressure can be ramped down";
    FillCoilShort = 14: 3, Vent, "more current than `coil_current_max_ma` at no more than `battery_max_v`, or some without being driven",
        "a driver that conducts without a command may be filling the chamber";
    VentCoilOpen = 15: 3, Off, "as `FillCoilOpen`, of the vent valve",
        "a coil that does not respond cannot vent the chamber; without current the spring sets the position of the valve";
    VentCoilShort = 16: 3, Off, "as `FillCoilShort`, of the vent valve",
        "the same, and a short circuit must not be supplied";
    BatteryLow = 17: 10, Hold, "below `battery_min_v`",
        "a voltage dip may end by itself; until then the valves may not follow the model";
    BatteryHigh = 18: 10, Hold, "above `battery_max_v`",
        "a load dump ends within half a second; switching the coils off protects the drivers";
    SampleTime = 19: 3, Release, "time since the last sample outside half to twice the sample time: overrun, missed or doubled samples",
        "gains and prediction are wrong by that factor; pulses need no exact time";
    ReferenceLost = 20: 5, Ramp, "no valid message, or a reference outside -1 bar to `supply_pressure_max_bar`",
        "the requested pressure is unknown; everything else works, so the pressure is ramped down";
    MemoryDamaged = 21: 1, Lock, "the configuration differs from its copy, or the supervisor's word from its complement; or the controller drives both valves although its settings do not allow it",
        "no number can be trusted, and no decision that uses one";
}

/// Set of faults, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FaultSet(u32);

impl FaultSet {
    /// Empty set.
    pub const NONE: Self = Self(0);

    /// Returns a set with one fault.
    pub const fn of(fault: Fault) -> Self {
        Self(1 << fault as u8)
    }

    /// Returns a set with `fault`, if `is_present`; otherwise an empty set.
    #[inline(always)]
    pub(crate) const fn when(is_present: bool, fault: Fault) -> Self {
        Self((is_present as u32) << fault as u8)
    }

    /// Creates a set from a word of [`FaultSet::bits`]; bits without a fault are dropped.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & ((1 << Fault::ALL.len()) - 1))
    }

    /// Returns one bit per fault: bit n is the fault with the number n.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Returns whether the set is empty.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns whether the set contains `fault`.
    pub const fn contains(self, fault: Fault) -> bool {
        self.has_any_of(Self::of(fault))
    }

    /// Returns the faults of either set.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns whether both sets have a fault in common.
    pub const fn has_any_of(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns the faults of this set that `other` does not contain.
    #[must_use]
    pub const fn difference(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Iterates over the faults in the order of their bits.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL
            .into_iter()
            .filter(move |&fault| self.contains(fault))
    }
}

impl fmt::Display for FaultSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        for (index, fault) in self.iter().enumerate() {
            if index > 0 {
                f.write_str(", ")?;
            }
            fmt::Debug::fmt(&fault, f)?;
        }
        Ok(())
    }
}
