//! Supervisor: chooses the mode of a sample, and limits the reference accordingly.

mod fault_reaction;
mod transition;

use controller::Pressure;

use crate::config::EcuConfig;
use crate::counted::counted;
use crate::detector::Observation;
use crate::fault::{Fault, FaultReaction, FaultSet};
use crate::mechanism::Mechanism;
use crate::mode::Mode;
use crate::supervisor::transition::Situation;

/// Highest reference that counts as zero: 0.05 bar gauge, 2⁻¹⁶. It is less than any deadband in use.
pub(crate) const ZERO_MAX: i32 = 3277;
/// N (samples) with the reference at zero before the chamber is filled.
pub(crate) const ZERO_N: u8 = 10;
/// N (samples) without a confirmed fault before it counts as gone.
pub(crate) const RECOVERY_N: u8 = 10;
/// N (samples) for which both valves are shut while a fault may pass.
pub(crate) const HOLD_N: u16 = 50;
/// N (samples) with the vent valve fully open: 2 s empty the largest chamber through the smallest orifice.
pub(crate) const VENT_N: u16 = 200;
/// N (samples) of venting in pulses: the same total time of an open valve.
pub(crate) const RELEASE_N: u16 = VENT_N * PULSE_PERIOD / PULSE_N;
/// Number of samples with the vent valve open in each [`PULSE_PERIOD`]: the valve opens and closes within two samples.
pub(crate) const PULSE_N: u16 = 4;
/// Period of the pulses (samples); a power of two.
pub(crate) const PULSE_PERIOD: u16 = 16;
/// Maximum number of faults from which the ECU recovers without a healthy interval in between.
pub(crate) const RETRIES: u8 = 3;
/// N (samples) of running without a fault, 60 s, after which the number of faults is reset.
pub(crate) const HEALTHY_N: u16 = 6000;

/// State of the supervisor between two samples.
///
/// Decisions whose flipped bit could fill the chamber or clear a fault are stored twice, the second time as their
/// complement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Supervisor {
    mode: Mode,
    latched: FaultSet,
    /// Number of faults since the start or since the loop was last healthy.
    occurrences: u8,
    /// Whether the reference was zero since the last reset or emptying of the chamber.
    is_enabled: bool,
    /// Whether the vent valve is permanently open while venting; otherwise it opens in pulses.
    vents_fully: bool,
    complement: u32,
    /// Number of samples until the time of this mode is over, if it has a limit.
    remaining: u16,
    clear_for: u8,
    zero_for: u8,
    healthy_for: u16,
    /// Upper limit of the reference; it follows the ramp down, and up again after a fault.
    ceiling: Pressure,
}

impl Supervisor {
    /// State after a reset.
    pub(crate) const NEW: Self = {
        let mut new = Self {
            mode: Mode::Waiting,
            latched: FaultSet::NONE,
            occurrences: 0,
            is_enabled: false,
            vents_fully: false,
            complement: 0,
            remaining: 0,
            clear_for: 0,
            zero_for: 0,
            healthy_for: 0,
            ceiling: Pressure::MAX_CONTROL,
        };
        new.seal();
        new
    };

    pub(crate) const fn mode(&self) -> Mode {
        self.mode
    }

    /// Returns the faults since the last entry into [`Mode::Running`].
    pub(crate) const fn latched(&self) -> FaultSet {
        self.latched
    }

    /// Runs one sample: chooses the mode from the observations and the last plausible pressure.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        config: &EcuConfig,
        observation: &Observation,
        pressure: Pressure,
        is_damaged: bool,
    ) {
        let damaged = FaultSet::when(is_damaged || !self.is_sound(), Fault::MemoryDamaged);
        let faults = observation
            .faults
            .union(config.limits.mechanisms.seen(damaged));
        self.count(observation, faults);

        let before = self.mode;
        let reaction = FaultReaction::of(faults);
        if reaction.is_some() && matches!(before, Mode::Waiting | Mode::Running) {
            self.occurrences = self.occurrences.saturating_add(1).min(RETRIES + 1);
        }
        let retries_left = self.occurrences <= RETRIES || !config.has(Mechanism::RetryLimit);
        let situation = Situation {
            reaction,
            recovered: self.clear_for >= RECOVERY_N && retries_left,
            at_zero: self.zero_for >= ZERO_N || !config.has(Mechanism::NeutralInterlock),
            is_over: self.is_over(config),
            is_enabled: self.is_enabled,
            retries_left,
        };
        self.mode = before.next(situation);
        self.latched = if config.has(Mechanism::Latch) {
            self.latched.union(faults)
        } else {
            faults
        };
        if self.mode != before {
            self.enter(config, before, observation.reference, pressure);
        }
        self.settle_venting(reaction, before, situation.is_over);
        self.lead(config, observation.reference);
        self.seal();
    }

    /// Returns the reference for the controller.
    #[inline(always)]
    pub(crate) fn reference(&self, reference: Pressure, pressure: Pressure) -> Pressure {
        let led = reference.min(self.ceiling);
        if self.mode == Mode::Running {
            led
        } else {
            // The reference is never above the pressure, so that the chamber is not filled and the integral part does
            // not grow.
            led.min(pressure)
        }
    }

    /// Returns whether the vent valve is open in this sample of [`Mode::Venting`].
    #[inline(always)]
    pub(crate) const fn vents_now(&self) -> bool {
        let left_in_period = self.remaining.wrapping_sub(1) & (PULSE_PERIOD - 1);
        self.vents_fully || left_in_period >= PULSE_PERIOD - PULSE_N
    }

    /// Releases the lock, if the defined procedure was followed.
    ///
    /// # Errors
    /// Returns the missing condition.
    pub(crate) fn release(&mut self) -> Result<(), ReleaseRefused> {
        if self.mode != Mode::Locked {
            return Err(ReleaseRefused::NotLocked);
        }
        if self.latched.contains(Fault::MemoryDamaged) {
            return Err(ReleaseRefused::MemoryDamaged);
        }
        if self.clear_for < RECOVERY_N {
            return Err(ReleaseRefused::FaultPresent);
        }
        if self.zero_for < ZERO_N {
            return Err(ReleaseRefused::ReferenceNotAtZero);
        }
        *self = Self {
            latched: self.latched,
            ..Self::NEW
        };
        self.seal();
        Ok(())
    }

    /// Locks the ECU, in every mode.
    #[inline(always)]
    pub(crate) fn lock(&mut self) {
        self.mode = Mode::Locked;
        self.is_enabled = false;
        self.latched = self.latched.union(FaultSet::of(Fault::MemoryDamaged));
        self.seal();
    }

    #[cfg(any(test, feature = "fault-seeding"))]
    pub(crate) fn damage(&mut self) {
        self.mode = Mode::Running;
    }

    #[inline(always)]
    fn count(&mut self, observation: &Observation, faults: FaultSet) {
        self.remaining = self.remaining.saturating_sub(1);
        self.clear_for = counted(self.clear_for, faults.is_empty());
        if faults.contains(Fault::ReferenceLost) {
            self.zero_for = 0;
        } else if observation.reference_is_new {
            self.zero_for = counted(self.zero_for, observation.reference.to_bits() <= ZERO_MAX);
        }
        self.healthy_for = if self.mode == Mode::Running {
            self.healthy_for.saturating_add(1)
        } else {
            0
        };
        if self.healthy_for >= HEALTHY_N {
            self.occurrences = 0;
        }
    }

    #[inline(always)]
    fn is_over(&self, config: &EcuConfig) -> bool {
        let is_time_over = self.remaining == 0;
        if self.mode == Mode::Ramping {
            self.ceiling <= Pressure::ZERO
        } else if self.mode == Mode::Venting {
            is_time_over && config.has(Mechanism::VentLimit) || !config.has(Mechanism::ActiveVent)
        } else {
            self.mode == Mode::Holding && is_time_over && config.has(Mechanism::HoldLimit)
        }
    }

    #[inline(always)]
    fn enter(&mut self, config: &EcuConfig, before: Mode, reference: Pressure, pressure: Pressure) {
        self.is_enabled &= matches!(self.mode, Mode::Running | Mode::Holding | Mode::Ramping);
        self.remaining = if self.mode == Mode::Holding {
            HOLD_N
        } else {
            RELEASE_N
        };
        let was_interrupted = before != Mode::Waiting;
        self.ceiling = Pressure::MAX_CONTROL;
        if self.mode == Mode::Running {
            self.is_enabled = true;
            self.latched = FaultSet::NONE;
            if was_interrupted && config.has(Mechanism::RecoveryRamp) {
                self.ceiling = pressure;
            }
        } else if self.mode == Mode::Ramping {
            self.ceiling = if config.has(Mechanism::Ramp) {
                pressure.min(reference)
            } else {
                Pressure::ZERO
            };
        }
    }

    /// Chooses between pulses and full venting: full once a fault requires it, and after a ramp, when little pressure
    /// is left.
    #[inline(always)]
    fn settle_venting(&mut self, reaction: Option<FaultReaction>, before: Mode, is_over: bool) {
        let is_asked = reaction == Some(FaultReaction::Vent) || before == Mode::Ramping && is_over;
        let vents_fully = self.mode == Mode::Venting && (self.vents_fully || is_asked);
        if vents_fully && !self.vents_fully {
            self.remaining = VENT_N;
        }
        self.vents_fully = vents_fully;
    }

    /// Moves the upper limit of the reference along the ramp.
    #[inline(always)]
    fn lead(&mut self, config: &EcuConfig, reference: Pressure) {
        let step = Pressure::from_bits(config.limits.ramp);
        if self.mode == Mode::Ramping {
            self.ceiling = self.ceiling.saturating_sub(step).max(Pressure::ZERO);
        } else if self.ceiling < reference {
            self.ceiling = self.ceiling.saturating_add(step);
        } else {
            self.ceiling = Pressure::MAX_CONTROL;
        }
    }

    /// Returns the decisions that are stored twice, in one word.
    #[inline(always)]
    const fn word(&self) -> u32 {
        let [mode, occurrences] = [self.mode as u32, self.occurrences as u32];
        let [is_enabled, vents_fully] = [self.is_enabled as u32, self.vents_fully as u32];
        mode.wrapping_add(occurrences << 3)
            .wrapping_add(is_enabled << 6)
            .wrapping_add(vents_fully << 7)
            .wrapping_add(self.latched.bits() << 8)
    }

    #[inline(always)]
    const fn is_sound(&self) -> bool {
        self.complement == !self.word()
    }

    #[inline(always)]
    const fn seal(&mut self) {
        self.complement = !self.word();
    }
}

/// Reason why a locked ECU stays locked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReleaseRefused {
    /// The ECU is not locked.
    #[error("the ECU is not locked")]
    NotLocked,
    /// The configuration was damaged: only a reset restores it.
    #[error("configuration or state were damaged: reset the ECU")]
    MemoryDamaged,
    /// A fault is still present.
    #[error("a fault is present, or was within the last {RECOVERY_N} samples: mend it first")]
    FaultPresent,
    /// The reference is not at zero.
    #[error("the reference was not at zero for {ZERO_N} samples: take it back first")]
    ReferenceNotAtZero,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_decision_is_kept_twice() {
        let changes: [fn(&mut Supervisor); 7] = [
            |changed| changed.mode = Mode::Running,
            |changed| changed.mode = Mode::Ramping,
            |changed| changed.occurrences = 1,
            |changed| changed.occurrences = RETRIES + 1,
            |changed| changed.is_enabled = true,
            |changed| changed.vents_fully = true,
            |changed| changed.latched = FaultSet::of(Fault::SensorOpen),
        ];
        let sound = Supervisor::NEW;
        assert!(sound.is_sound());
        for (number, change) in changes.iter().enumerate() {
            let mut changed = sound;
            change(&mut changed);
            assert!(!changed.is_sound(), "{number}");
            changed.seal();
            assert!(changed.is_sound());
            for other in &changes[number + 1..] {
                let mut both = changed;
                other(&mut both);
                assert!(!both.is_sound(), "{number}");
            }
        }
    }

    #[test]
    fn a_led_reference_is_followed_again_once_it_is_reached() {
        let settings = crate::settings::EcuSettings::bench();
        let config = EcuConfig::new(&settings).unwrap();
        let reference = Pressure::from_bits(5 << 16);
        for (below, expected) in [
            (0, Pressure::MAX_CONTROL.to_bits()),
            (1, (5 << 16) - 1 + config.limits.ramp),
        ] {
            let mut leading = Supervisor::NEW;
            leading.mode = Mode::Running;
            leading.ceiling = Pressure::from_bits((5 << 16) - below);
            leading.lead(&config, reference);
            assert_eq!(leading.ceiling.to_bits(), expected, "{below}");
        }
    }

    /// Each decision has its own bits.
    #[test]
    fn no_two_decisions_share_a_bit_of_the_word() {
        let mut all = Supervisor::NEW;
        all.mode = Mode::Locked;
        all.occurrences = RETRIES + 1;
        all.is_enabled = true;
        all.vents_fully = true;
        all.latched = FaultSet::from_bits(u32::MAX);
        assert_eq!(all.word(), 0x3FFF_FFE6);
    }
}
