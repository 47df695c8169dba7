//! What a diagnosis said, held against what the rig hides.

use std::collections::BTreeMap;

use super::super::format::{Answer, Class, Hidden};

/// Names given to one rig by the diagnosis or by a rule.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Named {
    /// The effects.
    pub effects: Vec<String>,
    /// Of each, the ids that it says it cannot tell from it.
    pub equivalents: BTreeMap<String, Vec<String>>,
}

/// How right the names are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Judgement {
    /// Hidden effects.
    pub hidden: usize,
    /// Names given.
    pub named: usize,
    /// Hidden effects that a name stands for.
    pub right: usize,
    /// Hidden effects named by their own id.
    pub by_own_id: usize,
}

impl Judgement {
    /// Holds names against an answer. Each name stands for one hidden effect at most.
    pub fn new(answer: &Answer, named: &Named) -> Self {
        let own = |effect: &str, hidden: &Hidden| {
            answer.class != Class::Beyond && effect == hidden.effect
        };
        let stands = |effect: &str, hidden: &Hidden| {
            let said = named.equivalents.get(effect);
            own(effect, hidden)
                || hidden.same.iter().any(|id| id == effect)
                || answer.class != Class::Beyond
                    && said.is_some_and(|ids| ids.contains(&hidden.effect))
        };
        Self {
            hidden: answer.hidden.len(),
            named: named.effects.len(),
            right: matched(&named.effects, &answer.hidden, &stands),
            by_own_id: matched(&named.effects, &answer.hidden, &own),
        }
    }

    /// Names that stand for nothing that is hidden.
    pub fn wrong(&self) -> usize {
        self.named - self.right
    }
}

/// Largest number of hidden effects that get a name each of their own.
fn matched(names: &[String], hidden: &[Hidden], stands: &impl Fn(&str, &Hidden) -> bool) -> usize {
    let Some((first, rest)) = hidden.split_first() else {
        return 0;
    };
    let without = matched(names, rest, stands);
    let with = (0..names.len())
        .filter(|&n| stands(&names[n], first))
        .map(|n| {
            let mut others = names.to_vec();
            others.remove(n);
            1 + matched(&others, rest, stands)
        });
    with.fold(without, usize::max)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::blind::format::{Profile, SCHEMA};
    use crate::reference_plant::catalogue::Kinship;

    pub(in super::super) fn answer(class: Class, hidden: &[(&str, &[&str])]) -> Answer {
        Answer {
            schema: SCHEMA.to_owned(),
            rig: "rig-001".to_owned(),
            class,
            poor: None,
            hidden: hidden
                .iter()
                .map(|(effect, same)| Hidden {
                    effect: (*effect).to_owned(),
                    law: String::new(),
                    kinship: Kinship::Matched,
                    same: same.iter().map(|&id| id.to_owned()).collect(),
                    size: 1.0,
                    unit: String::new(),
                    size_over_typical: 1.0,
                    shape: 0.5,
                    parameter: Some(("size".to_owned(), 1.0)),
                })
                .collect(),
            raw_excess: BTreeMap::new(),
            profiles: [Profile::Bench; 2],
            scatter: vec![],
        }
    }

    fn named(effects: &[(&str, &[&str])]) -> Named {
        Named {
            effects: effects.iter().map(|(id, _)| (*id).to_owned()).collect(),
            equivalents: effects
                .iter()
                .map(|(id, said)| {
                    let said = said.iter().map(|&id| id.to_owned()).collect();
                    ((*id).to_owned(), said)
                })
                .collect(),
        }
    }

    fn check(answer: &Answer, names: &[(&str, &[&str])], right: usize, own: usize, wrong: usize) {
        let judgement = Judgement::new(answer, &named(names));
        assert_eq!(
            (judgement.right, judgement.by_own_id, judgement.wrong()),
            (right, own, wrong),
            "{names:?} for {:?}",
            answer.hidden
        );
    }

    #[test]
    fn a_name_is_right_by_its_id_by_physics_or_by_a_declared_equivalent() {
        let lag = answer(Class::Matched, &[("sensor_lag", &["dead_volume"])]);
        check(&lag, &[], 0, 0, 0);
        check(&lag, &[("sensor_lag", &[])], 1, 1, 0);
        check(&lag, &[("dead_volume", &[])], 1, 0, 0);
        check(
            &lag,
            &[("gas_temperature", &["gas_temperature", "sensor_lag"])],
            1,
            0,
            0,
        );
        check(&lag, &[("gas_temperature", &["gas_temperature"])], 0, 0, 1);
    }

    #[test]
    fn one_effect_is_named_once() {
        let lag = answer(Class::Matched, &[("sensor_lag", &["dead_volume"])]);
        check(&lag, &[("dead_volume", &[]), ("sensor_lag", &[])], 1, 1, 1);
    }

    #[test]
    fn two_effects_need_two_names() {
        let two = answer(
            Class::Two,
            &[("sensor_lag", &["dead_volume"]), ("dead_volume", &[])],
        );
        check(&two, &[("dead_volume", &[])], 1, 1, 0);
        check(&two, &[("dead_volume", &[]), ("sensor_lag", &[])], 2, 2, 0);
        check(
            &two,
            &[("dead_volume", &[]), ("chamber_leak", &[])],
            1,
            1,
            1,
        );
    }

    #[test]
    fn a_plain_rig_has_no_right_name() {
        check(
            &answer(Class::Plain, &[]),
            &[("chamber_leak", &[])],
            0,
            0,
            1,
        );
    }

    #[test]
    fn beyond_the_library_a_name_is_right_by_physics_only() {
        let sticky = answer(Class::Beyond, &[("sticky_seat", &["static_friction"])]);
        check(&sticky, &[("static_friction", &[])], 1, 0, 0);
        check(
            &sticky,
            &[("flow_force", &["sticky_seat", "static_friction"])],
            0,
            0,
            1,
        );
    }
}
