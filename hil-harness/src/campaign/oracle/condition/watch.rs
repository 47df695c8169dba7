//! One row of the table, over time.

use super::Condition;
use crate::campaign::bounds;
use crate::campaign::oracle::fault_reaction::FaultReaction;

/// Condition over time.
#[derive(Clone, Copy, Debug)]
pub(in crate::campaign::oracle) struct Watch {
    pub(in crate::campaign::oracle) condition: Condition,
    /// Number of consecutive samples in which it was present.
    present_for: u32,
    /// Number of samples since it was last present.
    quiet_for: u32,
    is_answered: bool,
    /// Number of samples since it was gone: absent N times in a row.
    gone_for: u32,
    /// Number of samples before it in which no condition was present.
    calm_before: u32,
}

impl Watch {
    pub(super) const fn new(condition: Condition) -> Self {
        Self {
            condition,
            present_for: 0,
            quiet_for: u32::MAX,
            is_answered: false,
            gone_for: 0,
            calm_before: 0,
        }
    }

    /// Takes one sample; no condition was present for `calm_for` samples before it.
    pub(super) fn look(&mut self, is_present: bool, calm_for: u32) {
        let (n, _) = self.condition.rule();
        if is_present {
            if self.present_for == 0 {
                self.calm_before = calm_for;
            }
            self.present_for += 1;
            self.quiet_for = 0;
        } else {
            self.present_for = 0;
            self.quiet_for = self.quiet_for.saturating_add(1);
        }
        if self.present_for >= n {
            self.is_answered = true;
            self.gone_for = 0;
        } else if self.gone_for > 0 || self.quiet_for >= n {
            self.gone_for = self.gone_for.saturating_add(1);
            self.is_answered &= self.gone_for < bounds::RECOVERY_N;
        }
    }

    pub(in crate::campaign::oracle) fn reaction(&self) -> FaultReaction {
        self.condition.rule().1
    }

    /// Returns whether it had to be answered, and is not gone for long enough.
    pub(in crate::campaign::oracle) fn is_answered(&self) -> bool {
        self.is_answered
    }

    /// Returns whether it was present so recently that a target may still react to it.
    pub(super) fn is_recent(&self) -> bool {
        self.quiet_for < 2 * bounds::RECOVERY_N
    }

    /// Returns whether the target certainly had no active reaction when this condition began.
    pub(in crate::campaign::oracle) fn is_first(&self) -> bool {
        self.calm_before >= bounds::AWAY_SAMPLES
    }

    /// Returns the number of samples since the one in which it had to be answered, while it is present without a break.
    pub(in crate::campaign::oracle) fn answered_for(&self) -> Option<u32> {
        self.present_for
            .checked_sub(self.condition.rule().0)
            .filter(|_| self.is_answered)
    }
}
