//! The safety mechanisms that a test can take away, one at a time, to see that something notices.

#[cfg(test)]
mod tests;

/// A safety mechanism beside the detectors, each of which is one too.
///
/// Removing one exists only with the feature `mutilate`, which no image can be built with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Mechanism {
    /// A fault needs N samples that look wrong.
    Debounce = 0,
    /// Both valves are shut in a sample whose pressure is not plausible.
    ShutOnDoubt = 1,
    /// No sample without a reference opens the fill valve further.
    NoIncreaseWithoutReference = 2,
    /// Nothing is filled after a reset until the reference was seen at zero.
    NeutralInterlock = 3,
    /// What holds a fault ends in the safe state.
    HoldLimit = 4,
    /// The chamber is emptied before the coils are left without current.
    ActiveVent = 5,
    /// The chamber is emptied for a bounded time.
    VentLimit = 6,
    /// The reference is led down, not dropped.
    Ramp = 7,
    /// After a fault the reference rises no faster than the ramp.
    RecoveryRamp = 8,
    /// The controller takes over as if the pressure had been there before.
    BumplessTakeover = 9,
    /// A fault that comes back too often locks.
    RetryLimit = 10,
    /// A fault stays known until the defined procedure clears it.
    Latch = 11,
    /// Never both valves, unless the controller was set up to.
    BothValvesInterlock = 12,
}

impl Mechanism {
    /// Every mechanism, in the order of its number.
    pub const ALL: [Self; 13] = [
        Self::Debounce,
        Self::ShutOnDoubt,
        Self::NoIncreaseWithoutReference,
        Self::NeutralInterlock,
        Self::HoldLimit,
        Self::ActiveVent,
        Self::VentLimit,
        Self::Ramp,
        Self::RecoveryRamp,
        Self::BumplessTakeover,
        Self::RetryLimit,
        Self::Latch,
        Self::BothValvesInterlock,
    ];
}

/// What a test can damage while the ECU runs, to see what stands behind it.
#[cfg(any(test, feature = "mutilate"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Damage {
    /// A bit of the configuration: the vent valve is taken for the other kind.
    Config,
    /// Bits of the supervisor: it is in [`Mode::Running`](crate::Mode::Running), whatever it was in.
    Supervisor,
    /// The controller drives both valves from now on.
    Controller,
}

/// Which mechanisms and detectors are left.
#[cfg(any(test, feature = "mutilate"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Mechanisms {
    removed: u32,
    blind: crate::fault::FaultSet,
    /// Whether the controller is damaged and drives both valves.
    drives_both: bool,
}

/// All of them; takes no room.
#[cfg(not(any(test, feature = "mutilate")))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Mechanisms;

#[cfg(any(test, feature = "mutilate"))]
impl Mechanisms {
    pub(crate) const ALL: Self = Self {
        removed: 0,
        blind: crate::fault::FaultSet::NONE,
        drives_both: false,
    };

    pub(crate) const fn without(self, mechanism: Mechanism) -> Self {
        Self {
            removed: self.removed | 1 << mechanism as u8,
            ..self
        }
    }

    pub(crate) const fn without_detector(self, fault: crate::fault::Fault) -> Self {
        Self {
            blind: self.blind.union(crate::fault::FaultSet::of(fault)),
            ..self
        }
    }

    pub(crate) const fn driving_both(self) -> Self {
        Self {
            drives_both: true,
            ..self
        }
    }

    pub(crate) const fn drives_both(self) -> bool {
        self.drives_both
    }

    pub(crate) const fn has(self, mechanism: Mechanism) -> bool {
        self.removed & 1 << mechanism as u8 == 0
    }

    pub(crate) const fn seen(self, faults: crate::fault::FaultSet) -> crate::fault::FaultSet {
        faults.difference(self.blind)
    }
}

#[cfg(not(any(test, feature = "mutilate")))]
impl Mechanisms {
    pub(crate) const ALL: Self = Self;

    #[inline(always)]
    pub(crate) const fn drives_both(self) -> bool {
        false
    }

    #[inline(always)]
    pub(crate) const fn has(self, _: Mechanism) -> bool {
        true
    }

    #[inline(always)]
    pub(crate) const fn seen(self, faults: crate::fault::FaultSet) -> crate::fault::FaultSet {
        faults
    }
}

impl Mechanisms {
    /// N of a detector, or 1 without debounce.
    #[inline(always)]
    pub(crate) const fn samples(self, samples: u8) -> u8 {
        if self.has(Mechanism::Debounce) {
            samples
        } else {
            1
        }
    }
}
