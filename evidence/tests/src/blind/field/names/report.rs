//! Gates and tables of the named effects, as text and as JSON.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use super::super::super::score::gate::{Gate, gate};
use super::super::super::score::share::Share;
use super::super::format::FieldAnswer;
use super::super::thresholds::*;
use super::{Kept, NamedRig, OfRig};

/// Score of the named effects.
#[derive(Debug, Clone, Serialize)]
pub struct NamesReport {
    /// Rigs, and those whose diagnosis ended.
    pub rigs: Share,
    /// Gates.
    pub gates: Vec<Gate>,
    /// Diagnoses within their time: with few hidden effects, and with more.
    pub in_time: [Share; 2],
    /// Groups by number of hidden effects, rate of the logger, and signals.
    pub groups: Vec<Group>,
    /// Hidden effects that have to be named by removal cost: from the first to the second (noise floors), and those
    /// that are named.
    pub costs: Vec<([f64; 2], Share)>,
    /// Results by id of the hidden effect.
    pub effects: BTreeMap<String, OfEffect>,
    /// Rigs with a miss.
    pub misses: Vec<String>,
    /// Right names that better sensors keep, by draw with better sensors.
    pub kept: Vec<Kept>,
}

/// Rigs of one kind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Group {
    /// Kind.
    pub label: String,
    /// Number of rigs.
    pub rigs: usize,
    /// Hidden effects that have to be named, and those of them that are.
    pub named: Share,
    /// Rigs with a name that stands for no hidden effect.
    pub wrong: usize,
    /// Rigs whose hidden effects are all in the library, and those of them whose final plant meets the free-run gate.
    pub free_run: Share,
    /// Rigs whose diagnosis is within its time.
    pub in_time: usize,
}

/// Hidden effects of one id.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct OfEffect {
    /// Rigs that hide it.
    pub hidden: usize,
    /// Rigs on which it has to be named, and those of them on which it is.
    pub named: Share,
    /// Rigs on which it is named although this is not required.
    pub not_required: usize,
}

type Kind = (&'static str, fn(&FieldAnswer) -> bool);

/// Bands of removal costs in the tables (noise floors).
const COSTS: [[f64; 2]; 4] = [
    [ASKED_COST_MIN_FLOORS, 3.0],
    [3.0, 10.0],
    [10.0, 30.0],
    [30.0, f64::INFINITY],
];

/// Kinds of loggers in the tables.
const KINDS: [Kind; 5] = [
    ("20 to 50 Hz", |rig| rig.logger.rate_hz < 50.0),
    ("50 to 500 Hz", |rig| {
        (50.0..500.0).contains(&rig.logger.rate_hz)
    }),
    ("500 to 5000 Hz", |rig| rig.logger.rate_hz >= 500.0),
    ("currents logged", |rig| rig.logger.currents),
    ("no currents", |rig| !rig.logger.currents),
];

impl NamesReport {
    /// Scores these rigs.
    pub fn new(rigs: &[NamedRig]) -> Self {
        Self {
            rigs: Share::of(rigs, |rig| rig.finding.is_some()),
            gates: gates(rigs).to_vec(),
            in_time: [true, false].map(|few| {
                let of = rigs.iter().filter(|rig| rig.has_few_effects() == few);
                Share::of(of, |rig| rig.is_in_time())
            }),
            groups: groups(rigs),
            costs: costs(rigs),
            effects: effects(rigs),
            misses: rigs.iter().filter_map(NamedRig::miss).collect(),
            kept: Vec::new(),
        }
    }

    /// Returns whether every rig has an answer, and every gate passes.
    pub fn holds(&self) -> bool {
        self.rigs.count == self.rigs.of && self.gates.iter().all(|gate| gate.holds)
    }
}

fn gates(rigs: &[NamedRig]) -> [Gate; 5] {
    let hide_nothing = rigs.iter().filter(|rig| rig.hides_nothing());
    let hide_something = rigs.iter().filter(|rig| !rig.hides_nothing());
    let intervals = rigs.iter().flat_map(NamedRig::intervals);
    let in_library = rigs.iter().filter(|rig| rig.is_all_in_library());
    [
        gate(
            "a rig without effect gets a name",
            Share::of(hide_nothing, |rig| rig.has_false_name()),
            FALSE_NAME_SHARE_MAX,
            false,
        ),
        gate(
            "an effect that costs a noise floor is named",
            named_of_asked(rigs),
            NAMED_SHARE_MIN,
            true,
        ),
        gate(
            "a rig with effects gets a wrong name",
            Share::of(hide_something, |rig| rig.has_wrong_name()),
            WRONG_NAME_SHARE_MAX,
            false,
        ),
        gate(
            "95 % intervals contain the true value",
            Share::of(intervals, |one| one.fitted.contains(one.truth)),
            COVERAGE_MIN,
            true,
        ),
        gate(
            "free run at most 1.5 noise floors",
            Share::of(in_library, |rig| rig.runs_free()),
            FREE_RUN_SHARE_MIN,
            true,
        ),
    ]
}

fn named_of_asked<'a>(rigs: impl IntoIterator<Item = &'a NamedRig>) -> Share {
    let hidden = rigs.into_iter().flat_map(NamedRig::hidden);
    Share::of(hidden.filter(|one| one.is_asked), |one| one.is_named)
}

fn groups(rigs: &[NamedRig]) -> Vec<Group> {
    let most = rigs.iter().map(|rig| rig.answer.hidden.len()).max();
    let by_number = (0..=most.unwrap_or(0)).map(|number| {
        let of = |rig: &&NamedRig| rig.answer.hidden.len() == number;
        Group::new(format!("{number} hidden"), rigs.iter().filter(of))
    });
    let by_logger = KINDS.iter().map(|(label, is)| {
        let of = rigs.iter().filter(|rig| is(&rig.answer));
        Group::new((*label).to_owned(), of)
    });
    by_number.chain(by_logger).collect()
}

fn costs(rigs: &[NamedRig]) -> Vec<([f64; 2], Share)> {
    let share = |[low, high]: [f64; 2]| {
        let asked = rigs
            .iter()
            .flat_map(NamedRig::hidden)
            .filter(|one| one.is_asked);
        let within = asked.filter(|one| (low..high).contains(&one.cost));
        ([low, high], Share::of(within, |one| one.is_named))
    };
    COSTS.map(share).to_vec()
}

fn effects(rigs: &[NamedRig]) -> BTreeMap<String, OfEffect> {
    let mut effects: BTreeMap<String, OfEffect> = BTreeMap::new();
    for OfRig {
        hidden,
        is_asked,
        is_named,
        ..
    } in rigs.iter().flat_map(NamedRig::hidden)
    {
        let of = effects.entry(hidden.effect.clone()).or_default();
        of.hidden += 1;
        of.named.of += usize::from(is_asked);
        of.named.count += usize::from(is_asked && is_named);
        of.not_required += usize::from(!is_asked && is_named);
    }
    effects
}

impl Group {
    fn new<'a>(label: String, rigs: impl Iterator<Item = &'a NamedRig>) -> Self {
        let rigs: Vec<&NamedRig> = rigs.collect();
        let count = |is: fn(&NamedRig) -> bool| rigs.iter().filter(|rig| is(rig)).count();
        let in_library = rigs.iter().filter(|rig| rig.is_all_in_library());
        Self {
            label,
            rigs: rigs.len(),
            named: named_of_asked(rigs.iter().copied()),
            wrong: count(|rig| rig.judgement.wrong() > 0),
            free_run: Share::of(in_library, |rig| rig.runs_free()),
            in_time: count(NamedRig::is_in_time),
        }
    }
}

impl fmt::Display for NamesReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "diagnosed: {}", self.rigs)?;
        writeln!(f, "\ngates, with exact 95 % limits")?;
        self.gates
            .iter()
            .try_for_each(|gate| writeln!(f, "  {gate}"))?;
        writeln!(f, "\ndiagnoses in time")?;
        let [few, many] = self.in_time;
        let [few_s, many_s] = [FEW_EFFECTS_TIME_MAX, MANY_EFFECTS_TIME_MAX].map(|t| t.as_secs());
        writeln!(f, "  up to {FEW_EFFECTS} hidden effects, {few_s} s:  {few}")?;
        writeln!(f, "  more hidden effects, {many_s} s:  {many}")?;
        let kind = "kind";
        writeln!(f, "\n{kind:34} rigs asked named wrong free run of in time")?;
        for group in &self.groups {
            writeln!(
                f,
                "  {:32} {:4} {:5} {:5} {:5} {:8} {:2} {:7}",
                group.label,
                group.rigs,
                group.named.of,
                group.named.count,
                group.wrong,
                group.free_run.count,
                group.free_run.of,
                group.in_time
            )?;
        }
        writeln!(f, "\neffects asked for, by removal cost (noise floors)")?;
        for ([low, high], named) in &self.costs {
            writeln!(f, "  {low:3} to {high:3}: {named}")?;
        }
        let effect = "hidden effect";
        writeln!(f, "\n{effect:34} rigs asked named named unrequired")?;
        for (id, of) in &self.effects {
            writeln!(
                f,
                "  {id:32} {:4} {:5} {:5} {:13}",
                of.hidden, of.named.of, of.named.count, of.not_required
            )?;
        }
        writeln!(f, "\nmisses: {}", self.misses.len())?;
        for miss in &self.misses {
            writeln!(f, "  {miss}")?;
        }
        self.kept.iter().try_for_each(|kept| write!(f, "\n{kept}"))
    }
}
