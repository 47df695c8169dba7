//! Permission to fill.

use super::condition::{Condition, Conditions};
use super::fault_reaction::FaultReaction;
use super::{CampaignRequirement, Finding, Observation, Oracle, unless};
use crate::campaign::bounds;

/// Minimum time from one fault to another one that counts separately (samples): N of the slowest doubt and the
/// recovery, twice.
const IDLE_MIN: u32 = 2 * (bounds::DOUBT_N + bounds::RECOVERY_N);
/// Time below which a held fault is certainly over before the hold ends (samples).
const BRIDGED: u32 = bounds::HOLD_SAMPLES - 2 * bounds::RECOVERY_N;

/// Permissions that follow from the history of a run.
#[derive(Debug)]
pub(super) struct Permission {
    /// Whether the number of confirmations is known, which is so only for a fault that shows as one row.
    is_plain: bool,
    /// Whether the reference has to be zero first: after a reset, and after the chamber was emptied.
    needs_zero: bool,
    /// Number of consecutive samples with the reference at zero.
    zero_for: u32,
    /// Number of counted faults; above the limit the target locks.
    answered: u32,
    /// Time for which the target may still carry out a reaction (samples).
    away_for: u32,
    /// Number of samples since a fault was being answered.
    idle_for: u32,
    is_locked: bool,
    is_damaged: bool,
    comeback: Option<Comeback>,
}

/// Recovery after a fault that has passed: from the present pressure up a ramp to the reference.
#[derive(Clone, Copy, Debug)]
struct Comeback {
    /// Line of the ramp, until it has met the reference (bar).
    line_bar: f64,
    /// Highest pressure explained by the ramp or the reference (bar).
    reasonable_bar: f64,
    /// Number of samples for which the recovery is still checked.
    left: u32,
}

impl Comeback {
    fn from(pressure_bar: f64) -> Self {
        Self {
            line_bar: pressure_bar,
            reasonable_bar: pressure_bar,
            left: bounds::COMEBACK_SAMPLES,
        }
    }

    /// Takes one sample; returns `None` once the recovery is over.
    fn go_on(mut self, reference_bar: f64) -> Option<Self> {
        self.line_bar += bounds::RAMP_BAR_PER_SAMPLE;
        if self.line_bar >= reference_bar {
            self.line_bar = f64::INFINITY;
        }
        self.reasonable_bar = self.reasonable_bar.max(reference_bar.min(self.line_bar));
        if self.line_bar.is_infinite() {
            self.left -= 1;
        }
        (self.left > 0).then_some(self)
    }

    fn keeps(&self, pressure_bar: f64) -> bool {
        pressure_bar <= self.reasonable_bar + bounds::BUMP_BAR
    }
}

impl Permission {
    pub(super) fn new(is_plain: bool) -> Self {
        Self {
            is_plain,
            needs_zero: true,
            zero_for: 0,
            answered: 0,
            away_for: 0,
            idle_for: IDLE_MIN,
            is_locked: false,
            is_damaged: false,
            comeback: None,
        }
    }

    /// Returns whether memory was damaged and no reset has repaired it.
    pub(super) fn is_damaged(&self) -> bool {
        self.is_damaged
    }

    pub(super) fn look(&mut self, observation: &Observation, conditions: &Conditions) {
        if observation.is_first {
            *self = Self::new(self.is_plain);
        }
        if observation.is_released {
            self.is_locked = self.is_damaged;
            self.answered = 0;
            self.needs_zero = true;
        }
        let is_zero = observation
            .sensors
            .reference
            .is_some_and(|bits| (-65536..=bounds::ZERO_MAX).contains(&bits));
        self.zero_for = if is_zero { self.zero_for + 1 } else { 0 };
        self.answer(observation, conditions);
        // A target that emptied the chamber in this sample still counts the zeros before it.
        if self.zero_for >= bounds::ZERO_N {
            self.needs_zero = false;
        }
        self.come_back(observation, conditions);
    }

    fn answer(&mut self, observation: &Observation, conditions: &Conditions) {
        let idle_for = self.idle_for;
        let is_answering = conditions.answered().next().is_some();
        self.idle_for = if is_answering {
            0
        } else {
            idle_for.saturating_add(1)
        };
        if is_answering && idle_for > 0 {
            // This counts only if the target has certainly been running again.
            let is_running = !self.needs_zero && idle_for >= IDLE_MIN && self.away_for == 0;
            self.answered += u32::from(is_running && self.is_plain);
            self.comeback = None;
        }
        self.away_for = self.away_for.saturating_sub(1);
        for watch in conditions.answered() {
            let aborted_after = match watch.reaction() {
                FaultReaction::Hold => bounds::HOLD_SAMPLES + bounds::CHANGES,
                FaultReaction::Ramp => {
                    bounds::RAMP_SAMPLES - bounds::VENT_SAMPLES + bounds::CHANGES
                }
                FaultReaction::Release
                | FaultReaction::Vent
                | FaultReaction::Off
                | FaultReaction::Lock => 0,
            };
            let is_bridged = watch.reaction() == FaultReaction::Hold
                && watch.answered_for().is_none_or(|samples| samples < BRIDGED);
            if !is_bridged {
                self.away_for = bounds::AWAY_SAMPLES;
            }
            self.needs_zero |= watch
                .answered_for()
                .is_some_and(|samples| samples >= aborted_after);
            self.is_damaged |= watch.condition == Condition::Memory;
        }
        self.is_locked |= self.is_damaged || self.answered > bounds::RETRIES;
        if !is_answering && idle_for == 0 && !self.needs_zero && !self.is_locked {
            self.comeback = Some(Comeback::from(observation.pressure_bar));
        }
    }

    /// Checks the recovery until it is over, or the next condition begins: before that is confirmed the valves may move
    /// freely.
    fn come_back(&mut self, observation: &Observation, conditions: &Conditions) {
        let is_watched = !self.needs_zero && conditions.is_calm();
        let comeback = self.comeback.filter(|_| is_watched);
        self.comeback = comeback.and_then(|comeback| comeback.go_on(observation.reference_bar));
    }
}

/// Returns the violated requirements on filling.
pub(super) fn broken(observation: &Observation, oracle: &Oracle) -> [Finding; 3] {
    let permission = &oracle.permission;
    let [fill, _] = observation.coils;
    let filled = || format!("fill {fill:.2} %");
    let comeback = permission.comeback.filter(|_| oracle.is_plain);
    let is_smooth = comeback.is_none_or(|comeback| comeback.keeps(observation.pressure_bar));
    [
        unless(
            fill == 0.0 || !permission.needs_zero,
            CampaignRequirement::NeutralFirst,
            filled,
        ),
        unless(
            fill == 0.0 || !permission.is_locked,
            CampaignRequirement::StaysLocked,
            filled,
        ),
        unless(is_smooth, CampaignRequirement::NoBump, || {
            format!(
                "{:.3} bar after {:?}",
                observation.pressure_bar, permission.comeback
            )
        }),
    ]
}
