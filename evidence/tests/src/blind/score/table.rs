//! Tables of a score, as text and as JSON.

use std::fmt;

use serde::Serialize;

use super::super::format::{Class, Poor};
use super::finding::Finding;
use super::gate::{Gate, Quality};
use super::judge::Judgement;
use super::rules::RULES;
use super::share::Share;
use super::{STRATA, Scored};

/// Largest check error relative to the noise floor that counts as close.
const CLOSE_TO_THE_FLOOR: f64 = 1.5;

/// Score of the diagnosis.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Rigs, and those whose diagnosis ended.
    pub rigs: Share,
    /// Shares that the gates judge.
    pub quality: Quality,
    /// Gates.
    pub gates: Vec<Gate>,
    /// Rows by class and excess.
    pub strata: Vec<Row>,
    /// Rows of poor logs.
    pub poor: Vec<Row>,
    /// Rows of single effects by id.
    pub effects: Vec<Row>,
    /// Names by the simple rules.
    pub rules: Vec<(&'static str, Quality)>,
    /// Rightly named rigs whose last check error is within 1.5 of the noise floor.
    pub close_to_the_floor: Share,
    /// Median of the last check error relative to the noise floor, over rigs with right names.
    pub median_over_floor: Option<f64>,
    /// Intervals of the named parameter that contain its true value.
    pub coverage: Share,
    /// Relative error of the fitted values: the median, and the 90 % quantile.
    pub deviations: [Option<f64>; 2],
    /// Mean number of ids that a right name stands for, including its own.
    pub mean_set: Option<f64>,
    /// Misses by rig.
    pub misses: Vec<String>,
}

/// Row of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Row {
    /// Label.
    pub label: String,
    /// Number of rigs.
    pub rigs: usize,
    /// Rigs with all hidden effects named.
    pub right: usize,
    /// Rigs with all of them named by their own ids.
    pub by_own_id: usize,
    /// Rigs with a name that stands for no hidden effect.
    pub wrong: usize,
    /// Rigs without a name.
    pub unnamed: usize,
}

impl Row {
    fn new<'a>(label: impl Into<String>, rigs: impl IntoIterator<Item = &'a Scored>) -> Self {
        let mut row = Self {
            label: label.into(),
            rigs: 0,
            right: 0,
            by_own_id: 0,
            wrong: 0,
            unnamed: 0,
        };
        for rig in rigs {
            let found = rig.judgement;
            let some = found.hidden > 0;
            row.rigs += 1;
            row.right += usize::from(some && found.right == found.hidden);
            row.by_own_id += usize::from(some && found.by_own_id == found.hidden);
            row.wrong += usize::from(found.wrong() > 0);
            row.unnamed += usize::from(found.named == 0);
        }
        row
    }
}

impl Report {
    pub(super) fn new(rigs: &[Scored]) -> Self {
        let quality = Quality::new(rigs, |rig| rig.judgement);
        let right: Vec<&Scored> = rigs
            .iter()
            .filter(|rig| rig.has_library_effects() && all_right(rig.judgement))
            .collect();
        let findings: Vec<&Finding> = right
            .iter()
            .filter_map(|rig| rig.finding.as_ref())
            .collect();
        Self {
            rigs: Share::of(rigs, |rig| rig.finding.is_some()),
            gates: quality.gates().to_vec(),
            quality,
            strata: strata(rigs),
            poor: Poor::ALL
                .iter()
                .map(|&poor| {
                    let of = rigs.iter().filter(|rig| rig.answer.poor == Some(poor));
                    Row::new(format!("{poor:?}"), of)
                })
                .collect(),
            effects: effects(rigs),
            rules: RULES
                .iter()
                .enumerate()
                .map(|(n, rule)| (rule.name, Quality::new(rigs, |rig| rig.by_rules[n])))
                .collect(),
            close_to_the_floor: Share::of(&findings, |finding| {
                finding.last_over_floor() <= CLOSE_TO_THE_FLOOR
            }),
            median_over_floor: median(findings.iter().map(|f| f.last_over_floor()).collect()),
            coverage: Share::of(right.iter().flat_map(|rig| sizes(rig)), |size| size.is_held),
            deviations: [0.5, 0.9].map(|share| {
                let of = right.iter().flat_map(|rig| sizes(rig));
                quantile(of.map(|size| size.deviation).collect(), share)
            }),
            mean_set: mean_set(&findings),
            misses: rigs.iter().filter_map(miss).collect(),
        }
    }

    /// Returns whether all gates pass and every rig has a finding.
    pub fn holds(&self) -> bool {
        self.rigs.count == self.rigs.of && self.gates.iter().all(|gate| gate.holds)
    }
}

fn all_right(judgement: Judgement) -> bool {
    judgement.hidden > 0 && judgement.right == judgement.hidden && judgement.wrong() == 0
}

fn strata(rigs: &[Scored]) -> Vec<Row> {
    let classes = [
        Class::Plain,
        Class::Matched,
        Class::Variant,
        Class::Two,
        Class::Beyond,
    ];
    let mut rows = Vec::new();
    for class in classes {
        let of: Vec<&Scored> = rigs
            .iter()
            .filter(|rig| rig.answer.class == class)
            .collect();
        rows.push(Row::new(format!("{class:?}"), of.iter().copied()));
        for n in 0..=STRATA.len() {
            let low = if n == 0 { 0.0 } else { STRATA[n - 1] };
            let high = STRATA.get(n).copied().unwrap_or(f64::INFINITY);
            let within = |rig: &&&Scored| {
                rig.excess()
                    .is_some_and(|excess| (low..high).contains(&excess))
            };
            let row = Row::new(
                format!("  excess {low} to {high}"),
                of.iter().filter(within).copied(),
            );
            if row.rigs > 0 {
                rows.push(row);
            }
        }
    }
    rows
}

fn effects(rigs: &[Scored]) -> Vec<Row> {
    let mut ids: Vec<&str> = rigs
        .iter()
        .filter(|rig| rig.answer.hidden.len() == 1)
        .map(|rig| rig.answer.hidden[0].effect.as_str())
        .collect();
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter()
        .map(|id| {
            let of = rigs
                .iter()
                .filter(|rig| rig.answer.hidden.len() == 1 && rig.answer.hidden[0].effect == id);
            Row::new(id, of)
        })
        .collect()
}

/// Fitted value beside the true one.
struct Size {
    /// Whether the interval contains the true value.
    is_held: bool,
    /// Relative error.
    deviation: f64,
}

/// Returns the sizes of the effects named by their own id whose parameter the library has.
fn sizes(rig: &Scored) -> Vec<Size> {
    let Some(finding) = &rig.finding else {
        return vec![];
    };
    let sizes = rig.answer.hidden.iter();
    sizes
        .filter_map(|hidden| finding.size_of(hidden))
        .map(|(fitted, truth)| Size {
            is_held: fitted.contains(truth),
            deviation: (fitted.value / truth - 1.0).abs(),
        })
        .collect()
}

fn mean_set(findings: &[&Finding]) -> Option<f64> {
    let sizes: Vec<f64> = findings
        .iter()
        .flat_map(|finding| finding.effects.iter().map(|id| finding.set_size(id) as f64))
        .collect();
    (!sizes.is_empty()).then(|| sizes.iter().sum::<f64>() / sizes.len() as f64)
}

fn median(values: Vec<f64>) -> Option<f64> {
    quantile(values, 0.5)
}

/// Returns the quantile of the values at this share.
fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get((share * values.len() as f64) as usize).copied()
}

/// Returns one line on a rig with a wrong or missing answer.
fn miss(rig: &Scored) -> Option<String> {
    let found = rig.judgement;
    let missed = rig.is_to_be_found() && found.right == 0
        || rig.answer.class == Class::Two && found.right < 2;
    if found.wrong() == 0 && !missed && rig.finding.is_some() {
        return None;
    }
    let hidden: Vec<String> = rig
        .answer
        .hidden
        .iter()
        .map(|hidden| format!("{} ({})", hidden.effect, hidden.law))
        .collect();
    let said = rig.finding.as_ref().map_or_else(
        || "no answer".to_owned(),
        |finding| format!("{} {:?}", finding.verdict, finding.effects),
    );
    let excess = rig.excess().unwrap_or(f64::NAN);
    let poor = rig
        .answer
        .poor
        .map_or(String::new(), |poor| format!(", {poor:?}"));
    Some(format!(
        "{}: {:?}{poor}, hides {hidden:?}, excess {excess:.2}: {said}",
        rig.answer.rig, rig.answer.class
    ))
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.limits().map(|limit| 100.0 * limit);
        match self.value() {
            Some(value) => write!(
                f,
                "{:5.1} % ({} of {}; {low:.1} to {high:.1} %)",
                100.0 * value,
                self.count,
                self.of
            ),
            None => f.write_str("no rig"),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "diagnosed: {}", self.rigs)?;
        writeln!(f, "\nrequirements, with exact 95 % limits")?;
        self.gates
            .iter()
            .try_for_each(|gate| writeln!(f, "  {gate}"))?;
        writeln!(
            f,
            "  {:69} {}",
            "both of two effects are named, separable or not", self.quality.both_of_two
        )?;
        rows(f, "by kind and excess", &self.strata)?;
        rows(f, "poor logs", &self.poor)?;
        rows(f, "single effects", &self.effects)?;
        writeln!(f, "\nsimple rules on the same rigs")?;
        for (name, q) in &self.rules {
            writeln!(f, "  {name}")?;
            for gate in q.gates() {
                writeln!(f, "    {:48} {}", gate.requirement, gate.share)?;
            }
        }
        writeln!(f, "\nwhere all names are right")?;
        writeln!(
            f,
            "  last check error within {CLOSE_TO_THE_FLOOR} of the floor: {}",
            self.close_to_the_floor
        )?;
        if let (Some(median), Some(set)) = (self.median_over_floor, self.mean_set) {
            writeln!(f, "  median of last check error over floor: {median:.3}")?;
            writeln!(f, "  ids per name, equivalents included: {set:.2}")?;
        }
        writeln!(f, "  interval holds the true value: {}", self.coverage)?;
        if let [Some(half), Some(most)] = self.deviations.map(|one| one.map(|share| 100.0 * share))
        {
            writeln!(
                f,
                "  fitted value off by {half:.1} % (median), {most:.1} % (nine of ten)"
            )?;
        }
        writeln!(f, "\nmisses: {}", self.misses.len())?;
        self.misses
            .iter()
            .try_for_each(|miss| writeln!(f, "  {miss}"))
    }
}

fn rows(f: &mut fmt::Formatter<'_>, title: &str, rows: &[Row]) -> fmt::Result {
    writeln!(f, "\n{title:32} rigs right own id wrong unnamed")?;
    for row in rows {
        let Row {
            label,
            rigs,
            right,
            by_own_id,
            wrong,
            unnamed,
        } = row;
        writeln!(
            f,
            "  {label:30} {rigs:4} {right:5} {by_own_id:6} {wrong:5} {unnamed:7}"
        )?;
    }
    Ok(())
}
