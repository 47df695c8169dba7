//! Transitions between modes: a pure function of the situation in a sample.

use crate::fault::FaultReaction;
use crate::mode::Mode;

/// Inputs of the decision about the next mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Situation {
    /// Reaction to the confirmed faults; `None`: no fault.
    pub(crate) reaction: Option<FaultReaction>,
    /// Whether no fault was confirmed for the time of recovery, and retries are left.
    pub(crate) recovered: bool,
    /// Whether the reference was at zero for long enough.
    pub(crate) at_zero: bool,
    /// Whether the time limit of holding, ramping or venting is over.
    pub(crate) is_over: bool,
    /// Whether the chamber may be filled again without a reference of zero: it was zero since the last reset or
    /// emptying of the chamber.
    pub(crate) is_enabled: bool,
    /// Whether a fault may occur once more.
    pub(crate) retries_left: bool,
}

impl Mode {
    /// Returns the mode of this sample; `self` is the mode of the previous one.
    #[inline(always)]
    pub(crate) fn next(self, situation: Situation) -> Self {
        let Situation {
            reaction,
            recovered,
            at_zero,
            is_over,
            is_enabled,
            retries_left,
        } = situation;
        let safe = if retries_left {
            Self::Safe
        } else {
            Self::Locked
        };
        let resumed = if is_enabled {
            Self::Running
        } else {
            Self::Waiting
        };
        let is_interrupted = matches!(self, Self::Holding | Self::Ramping);
        if self == Self::Locked || reaction == Some(FaultReaction::Lock) {
            Self::Locked
        } else if reaction == Some(FaultReaction::Off) || self == Self::Safe && reaction.is_some() {
            safe
        } else if self == Self::Safe {
            if recovered { Self::Waiting } else { Self::Safe }
        } else if self == Self::Venting {
            if is_over { safe } else { Self::Venting }
        } else if reaction >= Some(FaultReaction::Release) || is_interrupted && is_over {
            Self::Venting
        } else if reaction == Some(FaultReaction::Hold) {
            // Without the sensor a ramp is impossible.
            if self == Self::Ramping {
                Self::Venting
            } else {
                Self::Holding
            }
        } else if reaction == Some(FaultReaction::Ramp) {
            Self::Ramping
        } else if is_interrupted && recovered {
            resumed
        } else if self == Self::Waiting && at_zero {
            Self::Running
        } else {
            self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table of docs/safety.md, row by row: the first matching row decides. `None` in a column means any.
    #[rustfmt::skip]
    fn expected(mode: Mode, s: Situation) -> Mode {
        use Mode::{Holding, Locked, Ramping, Running, Safe, Venting, Waiting};
        let locking = if s.retries_left { Safe } else { Locked };
        match mode {
            Locked => Locked,
            _ if s.reaction == Some(FaultReaction::Lock) => Locked,
            _ if s.reaction == Some(FaultReaction::Off) => locking,
            Safe => match s.reaction {
                Some(_) => locking,
                None => if s.recovered { Waiting } else { Safe },
            },
            Venting => if s.is_over { locking } else { Venting },
            _ if matches!(s.reaction, Some(FaultReaction::Vent | FaultReaction::Release)) => Venting,
            Holding => match (s.is_over, s.reaction, s.recovered) {
                (true, ..) => Venting,
                (_, Some(FaultReaction::Ramp), _) => Ramping,
                (_, Some(_), _) | (_, _, false) => Holding,
                (_, None, true) => if s.is_enabled { Running } else { Waiting },
            },
            Ramping => match (s.is_over, s.reaction, s.recovered) {
                (true, ..) | (_, Some(FaultReaction::Hold), _) => Venting,
                (_, Some(_), _) | (_, _, false) => Ramping,
                (_, None, true) => if s.is_enabled { Running } else { Waiting },
            },
            Waiting | Running => match s.reaction {
                Some(FaultReaction::Hold) => Holding,
                Some(_) => Ramping,
                None => if s.at_zero { Running } else { mode },
            },
        }
    }

    fn every_situation() -> impl Iterator<Item = Situation> {
        let reactions = [
            None,
            Some(FaultReaction::Hold),
            Some(FaultReaction::Ramp),
            Some(FaultReaction::Release),
            Some(FaultReaction::Vent),
            Some(FaultReaction::Off),
            Some(FaultReaction::Lock),
        ];
        reactions.into_iter().flat_map(|reaction| {
            (0..32).map(move |bits: u32| Situation {
                reaction,
                recovered: bits & 1 != 0,
                at_zero: bits & 2 != 0,
                is_over: bits & 4 != 0,
                is_enabled: bits & 8 != 0,
                retries_left: bits & 16 != 0,
            })
        })
    }

    #[test]
    fn every_transition_is_the_one_of_the_table() {
        let mut observation = 0;
        for mode in Mode::ALL {
            for situation in every_situation() {
                assert_eq!(
                    mode.next(situation),
                    expected(mode, situation),
                    "{mode:?}, {situation:?}"
                );
                observation += 1;
            }
        }
        assert_eq!(observation, 7 * 7 * 32);
    }

    #[test]
    fn a_confirmed_fault_is_never_answered_by_running() {
        for mode in Mode::ALL {
            for situation in every_situation().filter(|situation| situation.reaction.is_some()) {
                assert!(!matches!(
                    mode.next(situation),
                    Mode::Running | Mode::Waiting
                ));
            }
        }
    }

    #[test]
    fn nothing_but_a_release_leads_out_of_the_lock() {
        for situation in every_situation() {
            assert_eq!(Mode::Locked.next(situation), Mode::Locked);
        }
    }

    #[test]
    fn running_begins_at_a_reference_of_zero_or_where_it_was_interrupted() {
        for mode in Mode::ALL.into_iter().filter(|&mode| mode != Mode::Running) {
            for situation in every_situation() {
                if mode.next(situation) == Mode::Running {
                    let interrupted = matches!(mode, Mode::Holding | Mode::Ramping);
                    let allowed = if interrupted {
                        situation.is_enabled && situation.recovered
                    } else {
                        mode == Mode::Waiting && situation.at_zero
                    };
                    assert!(allowed, "{mode:?}, {situation:?}");
                }
            }
        }
    }
}
