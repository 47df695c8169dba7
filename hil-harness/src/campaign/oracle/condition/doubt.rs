//! Whether a pressure can be believed.

use super::rig::Rig;
use crate::campaign::bounds;
use crate::campaign::oracle::Seen;

/// The doubts about the pressure: no code, none of a pressure, or a jump.
#[derive(Debug, Default)]
pub(super) struct Doubt {
    /// The last pressure that nothing spoke against [bar gauge].
    believed_bar: Option<f64>,
    is_present: bool,
    /// Samples in a row with a jump against the pressure that is believed.
    jumps: u32,
    /// Samples in a row in which nothing spoke against the pressure, jumps from it aside.
    sound_for: u32,
    /// Samples since it moved faster than a valve can.
    steady_for: u32,
}

impl Doubt {
    /// One sample; whether its pressure cannot be believed.
    pub(super) fn look(&mut self, rig: &Rig, seen: &Seen) -> bool {
        self.is_present = self.speaks_against(rig, seen);
        self.is_present
    }

    /// Of the last sample.
    pub(super) fn is_present(&self) -> bool {
        self.is_present
    }

    /// Whether the pressure is sound for as long as it takes any target to think so, too.
    pub(super) fn is_long_over(&self) -> bool {
        !self.is_present && self.sound_for >= bounds::RECOVERY_N
    }

    /// Whether the shown pressure was moved by nothing but valves lately: a derivative part answers to any motion.
    pub(super) fn is_steady(&self) -> bool {
        self.steady_for >= bounds::SETTLING
    }

    fn speaks_against(&mut self, rig: &Rig, seen: &Seen) -> bool {
        let highest_bar = rig.supply_max_bar + bounds::ABOVE_SUPPLY_BAR + 0.01;
        let is_code = |bar: f64| {
            seen.sensors
                .pressure
                .is_some_and(|code| code >= bounds::CODE_MIN)
                && bar <= highest_bar
        };
        let Some(shown_bar) = seen.shown_bar().filter(|&bar| is_code(bar)) else {
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
        // Against which pressure a target judges that was in doubt a moment ago is its own affair.
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
