//! Comparison of the names of a diagnosis with the hidden effects.

use std::collections::BTreeMap;

use super::super::format::Hidden;

/// Names given to one rig by the diagnosis or by a rule.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Named {
    /// Effects.
    pub effects: Vec<String>,
    /// Ids that the diagnosis declares indistinguishable from each.
    pub equivalents: BTreeMap<String, Vec<String>>,
}

/// Correctness of the names.
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
    /// Compares names with hidden effects. Each name stands for at most one hidden effect.
    pub fn new(hidden: &[Hidden], named: &Named) -> Self {
        let names = named.names();
        let count = |assigned: Vec<Option<&str>>| assigned.into_iter().flatten().count();
        Self {
            hidden: hidden.len(),
            named: named.effects.len(),
            right: count(named.assigned(hidden)),
            by_own_id: count(assigned(&names, hidden, &is_own_id)),
        }
    }

    /// Returns the number of names that stand for no hidden effect.
    pub fn wrong(&self) -> usize {
        self.named - self.right
    }
}

impl Named {
    /// Returns the name that stands for each hidden effect. As many effects as possible have a name, earlier effects
    /// first.
    pub fn assigned(&self, hidden: &[Hidden]) -> Vec<Option<&str>> {
        assigned(&self.names(), hidden, &|name, hidden| {
            self.stands(name, hidden)
        })
    }

    fn names(&self) -> Vec<&str> {
        self.effects.iter().map(String::as_str).collect()
    }

    /// Returns whether a name stands for a hidden effect: by its id, by physics, or by a declared equivalent.
    fn stands(&self, name: &str, hidden: &Hidden) -> bool {
        let said = self.equivalents.get(name);
        is_own_id(name, hidden)
            || hidden.same.iter().any(|id| id == name)
            || hidden.is_in_library() && said.is_some_and(|ids| ids.contains(&hidden.effect))
    }
}

fn is_own_id(name: &str, hidden: &Hidden) -> bool {
    hidden.is_in_library() && name == hidden.effect
}

/// Returns the name that stands for each hidden effect, each name once: as many as possible, earlier ones first.
fn assigned<'a>(
    names: &[&'a str],
    hidden: &[Hidden],
    stands: &impl Fn(&str, &Hidden) -> bool,
) -> Vec<Option<&'a str>> {
    let Some((first, rest)) = hidden.split_first() else {
        return Vec::new();
    };
    let name_first = |n: Option<usize>| {
        let mut others = names.to_vec();
        let name = n.map(|n| others.remove(n));
        let mut all = vec![name];
        all.extend(assigned(&others, rest, stands));
        all
    };
    let named = (0..names.len()).filter(|&n| stands(names[n], first));
    let ways = named.map(Some).chain([None]).map(name_first);
    let worth = |way: &Vec<Option<&str>>| {
        let has_name: Vec<bool> = way.iter().map(Option::is_some).collect();
        (way.iter().flatten().count(), has_name)
    };
    ways.max_by_key(worth).unwrap_or_default()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::blind::format::{Answer, Class, Profile, SCHEMA};
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
                    kinship: match class {
                        Class::Beyond => Kinship::Beyond,
                        _ => Kinship::Matched,
                    },
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
        let judgement = Judgement::new(&answer.hidden, &named(names));
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

    /// If one name may stand for either effect, the first effect gets it, unless another name is left for the second.
    #[test]
    fn a_name_stands_for_the_effect_in_front_unless_both_can_have_one() {
        let two = answer(
            Class::Two,
            &[("dead_volume", &["sensor_lag"]), ("sensor_lag", &[])],
        );
        let one = named(&[("sensor_lag", &[])]);
        assert_eq!(one.assigned(&two.hidden), [Some("sensor_lag"), None]);
        let both = named(&[("sensor_lag", &[]), ("dead_volume", &[])]);
        assert_eq!(
            both.assigned(&two.hidden),
            [Some("dead_volume"), Some("sensor_lag")]
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
