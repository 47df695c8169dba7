//! What can be wrong.

use core::fmt;

/// A fault, named by what was seen: one pressure sensor cannot tell a valve that stays shut from a supply that is gone.
///
/// `docs/safety.md` has the rule of each, the causes it stands for and the way into the safe state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Fault {
    /// The sensor's code is at the lower rail: wire open, or short to ground.
    SensorOpen = 0,
    /// The sensor's code is at the upper rail: short to the supply.
    SensorShort = 1,
    /// The pressure is below what the sensor can measure.
    SensorBelowRange = 2,
    /// The pressure is above what the supply can give.
    SensorAboveRange = 3,
    /// The pressure moved faster than the valves could move it.
    SensorJump = 4,
    /// The converter gave no code.
    SensorMissing = 5,
    /// The code did not change by a single bit while a valve was driven.
    SensorStuck = 6,
    /// The chamber was vented for long and still shows a pressure.
    SensorOffset = 7,
    /// Filled, and the pressure did not rise: fill valve stuck closed, supply lost, vent valve stuck open.
    NoRise = 8,
    /// Vented, and the pressure did not fall: vent valve stuck closed, fill valve stuck open.
    NoFall = 9,
    /// The pressure rose without being filled: fill valve stuck open, sensor drifting up.
    UncommandedRise = 10,
    /// The pressure fell without being vented: vent valve stuck open, leak, sensor drifting down.
    UncommandedFall = 11,
    /// The pressure fell while filled: the supply is below the chamber.
    SupplyLost = 12,
    /// The fill valve's coil took no current.
    FillCoilOpen = 13,
    /// The fill valve's coil took too much current, or took some without command.
    FillCoilShort = 14,
    /// The vent valve's coil took no current.
    VentCoilOpen = 15,
    /// The vent valve's coil took too much current, or took some without command.
    VentCoilShort = 16,
    /// The battery's voltage is too low to hold a valve.
    BatteryLow = 17,
    /// The battery's voltage is too high for the coils.
    BatteryHigh = 18,
    /// Samples come too early or too late.
    SampleTime = 19,
    /// No valid message with a reference.
    ReferenceLost = 20,
    /// Configuration or latched state are not what was written.
    MemoryDamaged = 21,
}

impl Fault {
    /// Every fault, in the order of its bits.
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

/// Any number of faults, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FaultSet(u32);

impl FaultSet {
    /// No fault.
    pub const NONE: Self = Self(0);

    /// One fault.
    pub const fn of(fault: Fault) -> Self {
        Self(1 << fault as u8)
    }

    /// `fault`, if `is_present`.
    #[inline(always)]
    pub(crate) const fn when(is_present: bool, fault: Fault) -> Self {
        Self((is_present as u32) << fault as u8)
    }

    /// From a word of [`FaultSet::bits`]; bits that mean no fault are dropped.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & ((1 << Fault::ALL.len()) - 1))
    }

    /// One bit per fault: bit n is the fault with the number n.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether there is none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether `fault` is among them.
    pub const fn contains(self, fault: Fault) -> bool {
        self.has_any_of(Self::of(fault))
    }

    /// Those of both.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether both have a fault in common.
    pub const fn has_any_of(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Those of this set that `other` has not.
    #[must_use]
    pub const fn difference(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// One after the other, in the order of their bits.
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
