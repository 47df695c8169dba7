//! Faults.

use core::fmt;

/// Fault, named by its observation: one pressure sensor cannot distinguish a valve that stays shut from a lost supply.
///
/// `docs/safety.md` has the rule of each fault, its possible causes and the fault reaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Fault {
    /// The sensor's code is at the lower rail: wire open, or short to ground.
    SensorOpen = 0,
    /// The sensor's code is at the upper rail: short to the supply.
    SensorShort = 1,
    /// The pressure is below the sensor's range.
    SensorBelowRange = 2,
    /// The pressure is above the highest supply pressure.
    SensorAboveRange = 3,
    /// The pressure moved faster than the valves could move it.
    SensorJump = 4,
    /// The converter gave no code.
    SensorMissing = 5,
    /// The code did not change by a single bit while a valve was driven.
    SensorStuck = 6,
    /// The chamber was vented for a long time and still shows a pressure.
    SensorOffset = 7,
    /// The chamber was filled and the pressure did not rise: fill valve stuck closed, supply lost, vent valve stuck
    /// open.
    NoRise = 8,
    /// The chamber was vented and the pressure did not fall: vent valve stuck closed, fill valve stuck open.
    NoFall = 9,
    /// The pressure rose without filling: fill valve stuck open, sensor drifting up.
    UncommandedRise = 10,
    /// The pressure fell without venting: vent valve stuck open, leak, sensor drifting down.
    UncommandedFall = 11,
    /// The pressure fell while the chamber was filled: the supply pressure is below the chamber pressure.
    SupplyLost = 12,
    /// The fill valve's coil took no current.
    FillCoilOpen = 13,
    /// The fill valve's coil took too much current, or took some without command.
    FillCoilShort = 14,
    /// The vent valve's coil took no current.
    VentCoilOpen = 15,
    /// The vent valve's coil took too much current, or took some without command.
    VentCoilShort = 16,
    /// The supply voltage is too low to keep a valve open.
    BatteryLow = 17,
    /// The supply voltage is too high for the coils.
    BatteryHigh = 18,
    /// Samples run too early or too late.
    SampleTime = 19,
    /// No valid message with a reference.
    ReferenceLost = 20,
    /// Configuration or latched state differ from their copies.
    MemoryDamaged = 21,
}

impl Fault {
    /// All faults, in the order of their bits.
    pub const ALL: [Self; 22] = [
        Self::SensorOpen,
        Self::SensorShort,
        Self::SensorBelowRange,
        Self::SensorAboveRange,
        Self::SensorJump,
        Self::SensorMissing,
        Self::SensorStuck,
        Self::SensorOffset,
        Self::NoRise,
        Self::NoFall,
        Self::UncommandedRise,
        Self::UncommandedFall,
        Self::SupplyLost,
        Self::FillCoilOpen,
        Self::FillCoilShort,
        Self::VentCoilOpen,
        Self::VentCoilShort,
        Self::BatteryLow,
        Self::BatteryHigh,
        Self::SampleTime,
        Self::ReferenceLost,
        Self::MemoryDamaged,
    ];
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
