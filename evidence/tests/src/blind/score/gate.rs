//! Required quality of the names of the diagnosis, or of a rule.

use std::fmt;

use serde::Serialize;

use super::super::format::Class;
use super::Scored;
use super::judge::Judgement;
use super::share::Share;

/// Requirement for a share.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gate {
    /// Requirement in words.
    pub requirement: &'static str,
    /// Share that was found.
    pub share: Share,
    /// Exact 95 % limits of the share.
    pub limits: [f64; 2],
    /// Bound of the share.
    pub bound: f64,
    /// Whether the bound is the smallest or the largest value.
    pub is_least: bool,
    /// Whether the gate passes; it fails without data.
    pub holds: bool,
}

/// Shares by which names are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Quality {
    /// Plain rigs with a name.
    pub false_names: Share,
    /// Single detectable effects that are named.
    pub right_names: Share,
    /// Rigs with effects of the library that have a wrong name.
    pub wrong_names: Share,
    /// Rigs with an effect outside the library that have a name.
    pub named_outside: Share,
    /// Pairs of which both are named.
    pub both_of_two: Share,
    /// The same for pairs of which each effect is detectable beside the other one; empty if that was not computed.
    pub both_of_separable: Share,
}

impl Quality {
    /// Counts the shares of names that `judgement` selects.
    pub fn new(rigs: &[Scored], judgement: impl Fn(&Scored) -> Judgement) -> Self {
        let of = |class: Class| rigs.iter().filter(move |rig| rig.answer.class == class);
        Self {
            false_names: Share::of(of(Class::Plain), |rig| judgement(rig).named > 0),
            right_names: Share::of(rigs.iter().filter(|rig| rig.is_to_be_found()), |rig| {
                judgement(rig).right == 1
            }),
            wrong_names: Share::of(rigs.iter().filter(|rig| rig.has_library_effects()), |rig| {
                judgement(rig).wrong() > 0
            }),
            named_outside: Share::of(of(Class::Beyond), |rig| judgement(rig).wrong() > 0),
            both_of_two: Share::of(of(Class::Two), |rig| judgement(rig).right == 2),
            both_of_separable: Share::of(rigs.iter().filter(|rig| rig.is_separable()), |rig| {
                judgement(rig).right == 2
            }),
        }
    }

    /// Returns the gates.
    pub fn gates(&self) -> [Gate; 5] {
        [
            gate("a plain rig gets a name", self.false_names, 0.01, false),
            gate(
                "one effect of at least half the noise is named",
                self.right_names,
                0.95,
                true,
            ),
            gate(
                "a name stands for nothing that is there",
                self.wrong_names,
                0.02,
                false,
            ),
            gate(
                "what the library lacks gets a name",
                self.named_outside,
                0.03,
                false,
            ),
            gate(
                "both of two separable effects are named",
                self.both_of_separable,
                0.80,
                true,
            ),
        ]
    }
}

/// Returns the gate of a share with `bound` as its smallest, or largest, allowed value.
pub(in crate::blind) fn gate(
    requirement: &'static str,
    share: Share,
    bound: f64,
    is_least: bool,
) -> Gate {
    Gate {
        requirement,
        share,
        limits: share.limits(),
        bound,
        is_least,
        holds: share.value().is_some_and(|value| {
            if is_least {
                value >= bound
            } else {
                value <= bound
            }
        }),
    }
}

impl fmt::Display for Gate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.is_least { "at least" } else { "at most" };
        let verdict = if self.holds { "pass" } else { "FAIL" };
        let bound = format!("{sign} {:.0} %", 100.0 * self.bound);
        write!(
            f,
            "{:48} {bound:13} {verdict:6} {}",
            self.requirement, self.share
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::judge::tests::answer;
    use super::*;
    use crate::blind::score::finding::{Finding, Step};

    /// Returns a rig whose plain model has `excess`, and which got these names.
    fn rig(class: Class, hidden: &[&str], excess: f64, effects: &[&str]) -> Scored {
        let by_signal = |value: f64| [("p_ch".to_owned(), value)].into();
        let finding = Finding {
            verdict: String::new(),
            effects: effects.iter().map(|&id| id.to_owned()).collect(),
            equivalents: [].into(),
            error_steps: vec![Step {
                kind: "parameters_refitted".to_owned(),
                added: None,
                variant: None,
                fit_rms: by_signal(1.0),
                check_rms: by_signal((1.0 + excess * excess).sqrt()),
                noise_floor: by_signal(1.0),
                explained_share: None,
                free_parameters: 10,
            }],
            candidates: vec![],
        };
        let hidden: Vec<(&str, &[&str])> = hidden.iter().map(|&id| (id, &[] as &[&str])).collect();
        Scored::new(answer(class, &hidden), Some(finding), vec![], None)
    }

    fn quality(rigs: &[Scored]) -> Quality {
        Quality::new(rigs, |rig| rig.judgement)
    }

    /// Counted by hand.
    #[test]
    fn shares_are_those_of_a_count_by_hand() {
        let mut unfinished = rig(Class::Matched, &["eddy_currents"], 0.0, &[]);
        unfinished.finding = None;
        // The second effect of one pair is not detectable.
        let pair = |alone: [f64; 2], names: &[&str]| Scored {
            alone: alone.to_vec(),
            ..rig(Class::Two, &["sensor_lag", "eddy_currents"], 2.0, names)
        };
        let rigs = [
            rig(Class::Plain, &[], 0.1, &[]),
            rig(Class::Plain, &[], 0.1, &["sensor_lag"]),
            rig(Class::Matched, &["chamber_leak"], 0.6, &["chamber_leak"]),
            rig(
                Class::Variant,
                &["chamber_leak"],
                5.0,
                &["chamber_leak", "flow_force"],
            ),
            rig(Class::Matched, &["chamber_leak"], 0.4, &[]),
            rig(Class::Matched, &["chamber_leak"], 0.4, &["flow_force"]),
            unfinished,
            pair([2.0, 0.4], &["sensor_lag"]),
            pair([0.5, 3.0], &["eddy_currents", "sensor_lag"]),
            pair([0.6, 0.7], &["eddy_currents"]),
            rig(Class::Beyond, &["sensor_bow"], 2.0, &[]),
            rig(Class::Beyond, &["sensor_bow"], 2.0, &["sensor_offset"]),
        ];
        let share = |count, of| Share { count, of };
        assert_eq!(
            quality(&rigs),
            Quality {
                false_names: share(1, 2),
                // Two are detectable; one without an answer counts as missed.
                right_names: share(2, 3),
                wrong_names: share(2, 8),
                named_outside: share(1, 2),
                both_of_two: share(1, 3),
                both_of_separable: share(1, 2),
            }
        );
    }

    #[test]
    fn a_gate_holds_at_its_bound_and_not_beyond_it() {
        let of = |count, of| Share { count, of };
        assert!(gate("", of(95, 100), 0.95, true).holds);
        assert!(!gate("", of(94, 100), 0.95, true).holds);
        assert!(gate("", of(2, 100), 0.02, false).holds);
        assert!(!gate("", of(3, 100), 0.02, false).holds);
        assert!(
            !gate("", of(0, 0), 0.02, false).holds,
            "without data no requirement is met"
        );
    }
}
