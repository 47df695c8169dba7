//! Safety mechanisms that a test can remove, one at a time, to check that the removal is detected.

#[cfg(test)]
mod tests;

/// Safety mechanism in addition to the detectors; each detector is a safety mechanism, too.
///
/// A test removes one with the feature `fault-seeding`. The build of an image with this feature fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Mechanism {
    /// A fault is confirmed only by N samples that look wrong.
    Debounce = 0,
    /// Both valves are shut in a sample with an implausible pressure.
    ShutOnDoubt = 1,
    /// No sample without a reference opens the fill valve further.
    NoIncreaseWithoutReference = 2,
    /// The chamber is not filled after a reset until the reference was zero.
    NeutralInterlock = 3,
    /// Holding has a time limit, after which the ECU goes to the safe state.
    HoldLimit = 4,
    /// The chamber is emptied before the coils are switched off.
    ActiveVent = 5,
    /// The time for emptying the chamber is limited.
    VentLimit = 6,
    /// The reference is ramped down to zero instead of dropped.
    Ramp = 7,
    /// After a fault the reference rises no faster than the ramp.
    RecoveryRamp = 8,
    /// The controller takes over as if the pressure had been constant before.
    BumplessTakeover = 9,
    /// A fault that recurs too often locks the ECU.
    RetryLimit = 10,
    /// A fault stays latched until the defined procedure clears it.
    Latch = 11,
    /// Both valves are never driven together, unless the settings allow it.
    BothValvesInterlock = 12,
}

impl Mechanism {
    /// All mechanisms, in the order of their numbers.
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

/// Damage that a test can cause while the ECU runs, to check that it is detected.
#[cfg(any(test, feature = "fault-seeding"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Damage {
    /// A flipped choice in the configuration: the vent valve counts as the other kind.
    Config,
    /// Flipped bits of the supervisor: the mode becomes [`Mode::Running`](crate::Mode::Running).
    Supervisor,
    /// A damaged controller that drives both valves from now on.
    Controller,
}

/// Mechanisms and detectors that are not removed.
#[cfg(any(test, feature = "fault-seeding"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Mechanisms {
    removed: u32,
    blind: crate::fault::FaultSet,
    /// Whether the controller is damaged and drives both valves.
    drives_both: bool,
}

/// All mechanisms; a type without size.
#[cfg(not(any(test, feature = "fault-seeding")))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Mechanisms;

#[cfg(any(test, feature = "fault-seeding"))]
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

#[cfg(not(any(test, feature = "fault-seeding")))]
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
    /// Returns N of a detector, or 1 without debounce.
    #[inline(always)]
    pub(crate) const fn samples(self, samples: u8) -> u8 {
        if self.has(Mechanism::Debounce) {
            samples
        } else {
            1
        }
    }
}
