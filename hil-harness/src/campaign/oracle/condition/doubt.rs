//! Plausibility of the pressure.

use super::rig::Rig;
use crate::campaign::bounds;
use crate::campaign::oracle::Observation;

/// Doubts about the pressure: a missing code, a code outside the range, or a jump.
#[derive(Debug, Default)]
pub(super) struct Doubt {
    /// Last plausible pressure (bar gauge).
    believed_bar: Option<f64>,
    is_present: bool,
    /// Number of consecutive samples with a jump against the last plausible pressure.
    jumps: u32,
    /// Number of consecutive samples with a plausible pressure, apart from jumps.
    sound_for: u32,
    /// Number of samples since the pressure moved faster than a valve can move it.
    steady_for: u32,
}

impl Doubt {
    /// Takes one sample; returns whether its pressure is implausible.
    pub(super) fn look(&mut self, rig: &Rig, observation: &Observation) -> bool {
        self.is_present = self.speaks_against(rig, observation);
        self.is_present
    }

    /// Returns whether the pressure of the last sample was implausible.
    pub(super) fn is_present(&self) -> bool {
        self.is_present
    }

    /// Returns whether the pressure has been plausible for so long that every target accepts it.
    pub(super) fn is_long_over(&self) -> bool {
        !self.is_present && self.sound_for >= bounds::RECOVERY_N
    }

    /// Returns whether only valves have recently changed the shown pressure: a derivative part responds to any change.
    pub(super) fn is_steady(&self) -> bool {
        self.steady_for >= bounds::SETTLING
    }

    fn speaks_against(&mut self, rig: &Rig, observation: &Observation) -> bool {
        let highest_bar = rig.supply_max_bar + bounds::ABOVE_SUPPLY_BAR + 0.01;
        let is_code = |bar: f64| {
            observation
                .sensors
                .pressure
                .is_some_and(|code| code >= bounds::CODE_MIN)
                && bar <= highest_bar
        };
        let Some(shown_bar) = observation.shown_bar().filter(|&bar| is_code(bar)) else {
            self.sound_for = 0;
            return true;
        };
        let moved_bar = self
            .believed_bar
            .map_or(0.0, |believed| (shown_bar - believed).abs());
        self.steady_for = if moved_bar > bounds::FASTEST_BAR {
            0
        } else {
            self.steady_for.saturating_add(1)
        };
        // The pressure with which a target compares shortly after a doubt is not specified.
        let is_sure = self.sound_for >= bounds::HOLD_SAMPLES && self.jumps < bounds::DOUBT_N;
        let has_jumped = is_sure && moved_bar > rig.jump_bar + 0.02;
        if has_jumped {
            self.jumps += 1;
        } else {
            let was_doubted = self.jumps > 0 || moved_bar > rig.jump_bar - 0.02;
            self.jumps = 0;
            self.sound_for = if was_doubted {
                0
            } else {
                self.sound_for.saturating_add(1)
            };
            self.believed_bar = Some(shown_bar);
        }
        has_jumped
    }
}
