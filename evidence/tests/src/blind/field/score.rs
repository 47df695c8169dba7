//! Comparison of the refined plants of a draw of field rigs with the sealed answers: gates with exact limits, and every
//! miss.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;

use plant_sim::PlantParameters;
use serde::Serialize;

use super::super::format::{Folders, Stage};
use super::super::score::gate::{Gate, gate};
use super::super::score::share::Share;
use super::super::score::{ScoreError, answers, found};
use super::finding::{Estimated, Worst};
use super::format::FieldAnswer;
use super::ordinary::first_file;
use super::thresholds::*;

/// Rig with its findings.
#[derive(Debug, Clone)]
pub struct FieldScored {
    /// Answer.
    pub answer: FieldAnswer,
    /// Time of the refinement (s).
    pub seconds: Option<f64>,
    /// Result of the refinement; `None` if it did not end.
    pub refined: Option<Estimated>,
    /// Errors of the true parameters; `None` if they were not computed.
    pub truth: Option<Estimated>,
}

/// Parameter that was called determined.
#[derive(Debug, Clone, PartialEq)]
struct Determined {
    name: String,
    after: f64,
    truth: f64,
    half_widths_off: f64,
}

impl FieldScored {
    fn check_error(&self) -> Option<Worst> {
        self.refined.as_ref()?.check_error()
    }

    fn reaches_the_floor(&self) -> bool {
        self.check_error().is_some_and(is_at_the_floor)
    }

    /// Returns the check error of the true parameters.
    fn truths_check_error(&self) -> Option<Worst> {
        self.truth.as_ref()?.check_error()
    }

    fn is_in_time(&self) -> bool {
        self.seconds
            .is_some_and(|seconds| seconds <= TIME_MAX.as_secs_f64())
    }

    /// Returns the free-run check errors of the refined plant and of the true parameters (noise floors).
    fn free_runs(&self) -> Option<[Worst; 2]> {
        let (refined, truth) = (self.refined.as_ref()?, self.truth.as_ref()?);
        Some([refined.free_run(refined)?, truth.free_run(refined)?])
    }

    fn over_truth(&self) -> Option<f64> {
        let [refined, truth] = self.free_runs()?;
        Some(refined.floors / truth.floors)
    }

    fn runs_free_like_truth(&self) -> bool {
        self.over_truth()
            .is_some_and(|ratio| ratio <= FREE_RUN_MAX_OVER_TRUTH)
    }

    fn determined(&self) -> Vec<Determined> {
        let first = first_file(self.answer.is_vent_normally_open);
        let first = PlantParameters::from_toml(&first, "first file").expect("it is a plant file");
        let refined = self.refined.iter().flat_map(|refined| &refined.parameters);
        let determined = refined.filter(|parameter| parameter.is_determined());
        determined
            .filter_map(|parameter| {
                let drawn = self.answer.parameters.get(&parameter.name).copied();
                let truth = drawn.or_else(|| first.get(&parameter.name))?;
                Some(Determined {
                    name: parameter.name.clone(),
                    after: parameter.after,
                    truth,
                    half_widths_off: parameter.half_widths_off(truth),
                })
            })
            .collect()
    }

    /// Returns one line for each miss.
    fn misses(&self) -> Vec<String> {
        let Some(refined) = &self.refined else {
            return vec!["no answer".to_owned()];
        };
        let mut misses = Vec::new();
        if let Some(worst) = refined.check_error().filter(|_| !self.reaches_the_floor()) {
            let truth = self.truths_check_error();
            let truth = truth.map_or(f64::NAN, |truth| truth.floors);
            misses.push(format!(
                "check error {:.2} floors of {}, with the true parameters {truth:.2}",
                worst.floors, worst.signal
            ));
        }
        if !self.is_in_time() {
            misses.push(format!("{:.0} s", self.seconds.unwrap_or(f64::NAN)));
        }
        match self.free_runs() {
            None => misses.push("free run of the true parameters not known".to_owned()),
            Some([ours, truth]) if !self.runs_free_like_truth() => misses.push(format!(
                "free run {:.2} floors of {}, with the true parameters {:.2} of {}",
                ours.floors, ours.signal, truth.floors, truth.signal
            )),
            Some(_) => (),
        }
        for one in self.determined() {
            if one.half_widths_off > 1.0 {
                let share = match one.truth {
                    0.0 => String::new(),
                    truth => format!(" ({:+.1} %)", 100.0 * (one.after / truth - 1.0)),
                };
                misses.push(format!(
                    "{} {:.4e}, truly {:.4e}{share}: {:.1} half widths off",
                    one.name, one.after, one.truth, one.half_widths_off
                ));
            }
        }
        misses
    }
}

fn is_at_the_floor(worst: Worst) -> bool {
    worst.floors <= CHECK_ERROR_MAX_FLOORS
}

/// Score of the refined plants.
#[derive(Debug, Clone, Serialize)]
pub struct FieldReport {
    /// Rigs, and those whose refinement ended.
    pub rigs: Share,
    /// Gates.
    pub gates: Vec<Gate>,
    /// Groups by kind of rig.
    pub groups: Vec<Group>,
    /// Intervals by parameter: those that contain the true value, of those called determined.
    pub coverage: BTreeMap<String, Share>,
    /// Misses by rig.
    pub misses: Vec<String>,
}

/// Rigs of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Kind.
    pub label: &'static str,
    /// Rigs with a check error at the noise floor.
    pub at_the_floor: Share,
    /// Rigs with a check error of the true parameters at the noise floor.
    pub truth_at_the_floor: Share,
    /// Rigs that are refined within the time limit.
    pub in_time: Share,
    /// Rigs whose free-run error is within the gate relative to that of the true parameters.
    pub free_run: Share,
    /// Median of the check error (noise floors).
    pub median_floors: f64,
    /// Median of the time (s).
    pub median_s: f64,
}

type Kind = (&'static str, fn(&FieldAnswer) -> bool);

/// Kinds of rigs in the tables; a rig may be of several.
const KINDS: [Kind; 12] = [
    ("normally closed", |rig| !rig.is_vent_normally_open),
    ("vent normally open", |rig| rig.is_vent_normally_open),
    ("below 100 Hz", |rig| rig.logger.rate_hz < 100.0),
    ("100 to 400 Hz", |rig| {
        (100.0..400.0).contains(&rig.logger.rate_hz)
    }),
    ("from 400 Hz", |rig| rig.logger.rate_hz >= 400.0),
    ("currents logged", |rig| rig.logger.currents),
    ("no currents", |rig| !rig.logger.currents),
    ("converter coarser than the noise", |rig| is_coarse(rig)),
    ("noise at least a converter step", |rig| !is_coarse(rig)),
    ("a log begins warm", |rig| begins_warm(rig)),
    ("both logs begin at rest", |rig| !begins_warm(rig)),
    ("at rest, from 100 Hz", |rig| {
        !begins_warm(rig) && rig.logger.rate_hz >= 100.0
    }),
];

fn is_coarse(rig: &FieldAnswer) -> bool {
    rig.logger.noise_bar < super::logger::RANGE_BAR / f64::from(1_u32 << rig.logger.bits)
}

fn begins_warm(rig: &FieldAnswer) -> bool {
    rig.logs.iter().any(|log| log.relaxation_s > 0.0)
}

/// Reads answers and findings of a draw, and scores them.
///
/// # Errors
/// Returns an error if an answer or a finding cannot be read. A missing finding is a miss of every gate.
pub fn score(folders: &Folders) -> Result<FieldReport, ScoreError> {
    let seconds = seconds(&folders.found())?;
    let answers: Vec<FieldAnswer> = answers(folders)?;
    let rigs = answers.into_iter().map(|answer| {
        Ok(FieldScored {
            seconds: seconds.get(&answer.rig).copied(),
            refined: found(&folders.found().finding(&answer.rig))?,
            truth: found(&folders.judged_truth(&answer.rig))?,
            answer,
        })
    });
    let rigs: Vec<FieldScored> = rigs.collect::<Result<_, ScoreError>>()?;
    Ok(FieldReport::new(&rigs))
}

/// Returns the time of the last command of each rig (s).
pub(super) fn seconds(stage: &Stage) -> Result<BTreeMap<String, f64>, ScoreError> {
    let times = stage.times();
    if !times.exists() {
        return Ok(BTreeMap::new());
    }
    let text = fs::read_to_string(&times).map_err(|error| ScoreError::Read(times, error))?;
    let times = text.lines().filter_map(|line| {
        let (rig, rest) = line.split_once(',')?;
        let seconds = rest.split(',').next()?.parse().ok()?;
        Some((rig.to_owned(), seconds))
    });
    Ok(times.collect())
}

impl FieldReport {
    /// Scores these rigs.
    pub fn new(rigs: &[FieldScored]) -> Self {
        let determined: Vec<Determined> = rigs.iter().flat_map(FieldScored::determined).collect();
        let mut coverage: BTreeMap<String, Share> = BTreeMap::new();
        for one in &determined {
            let share = coverage.entry(one.name.clone()).or_default();
            share.of += 1;
            share.count += usize::from(one.half_widths_off <= 1.0);
        }
        Self {
            rigs: Share::of(rigs, |rig| rig.refined.is_some()),
            gates: gates(rigs, &determined).to_vec(),
            groups: KINDS
                .iter()
                .filter_map(|&(label, is)| Group::new(label, rigs, is))
                .collect(),
            coverage,
            misses: rigs
                .iter()
                .flat_map(|rig| {
                    let misses = rig.misses().into_iter();
                    misses.map(|miss| format!("{} ({}): {miss}", rig.answer.rig, rig.answer.kind()))
                })
                .collect(),
        }
    }

    /// Returns whether every rig has an answer, and every gate passes.
    pub fn holds(&self) -> bool {
        self.rigs.count == self.rigs.of && self.gates.iter().all(|gate| gate.holds)
    }
}

fn gates(rigs: &[FieldScored], determined: &[Determined]) -> [Gate; 4] {
    [
        gate(
            "check error at most 1.1 noise floors, in time",
            Share::of(rigs, |rig| rig.reaches_the_floor() && rig.is_in_time()),
            CHECK_ERROR_SHARE_MIN,
            true,
        ),
        gate(
            "free run at most 1.2 times that of the truth",
            Share::of(rigs, |rig| rig.runs_free_like_truth()),
            FREE_RUN_SHARE_MIN,
            true,
        ),
        gate(
            "95 % intervals contain the true value",
            Share::of(determined, |one| one.half_widths_off <= 1.0),
            COVERAGE_MIN,
            true,
        ),
        gate(
            "determined values off by two half widths",
            Share::of(determined, |one| one.half_widths_off > FAR_OFF_HALF_WIDTHS),
            FAR_OFF_SHARE_MAX,
            false,
        ),
    ]
}

impl Group {
    fn new(
        label: &'static str,
        rigs: &[FieldScored],
        is: fn(&FieldAnswer) -> bool,
    ) -> Option<Self> {
        let of: Vec<&FieldScored> = rigs.iter().filter(|rig| is(&rig.answer)).collect();
        let median = |value: fn(&FieldScored) -> Option<f64>| {
            let mut values: Vec<f64> = of
                .iter()
                .map(|rig| value(rig).unwrap_or(f64::INFINITY))
                .collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied()
        };
        Some(Self {
            label,
            at_the_floor: Share::of(&of, |rig| rig.reaches_the_floor()),
            truth_at_the_floor: Share::of(&of, |rig| {
                rig.truths_check_error().is_some_and(is_at_the_floor)
            }),
            in_time: Share::of(&of, |rig| rig.is_in_time()),
            free_run: Share::of(&of, |rig| rig.runs_free_like_truth()),
            median_floors: median(|rig| rig.check_error().map(|worst| worst.floors))?,
            median_s: median(|rig| rig.seconds)?,
        })
    }
}

impl fmt::Display for FieldReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "refined: {}", self.rigs)?;
        writeln!(f, "\ngates, with exact 95 % limits")?;
        self.gates
            .iter()
            .try_for_each(|gate| writeln!(f, "  {gate}"))?;
        let kind = "kind";
        writeln!(
            f,
            "\n{kind:34} rigs at floor truth in time free run   median floors, s"
        )?;
        for group in &self.groups {
            writeln!(
                f,
                "  {:32} {:4} {:8} {:5} {:7} {:8} {:15.2} {:4.0}",
                group.label,
                group.at_the_floor.of,
                group.at_the_floor.count,
                group.truth_at_the_floor.count,
                group.in_time.count,
                group.free_run.count,
                group.median_floors,
                group.median_s
            )?;
        }
        writeln!(
            f,
            "\nintervals that contain the true value, of those called determined"
        )?;
        for (name, share) in &self.coverage {
            writeln!(f, "  {name:36} {:3} of {:3}", share.count, share.of)?;
        }
        writeln!(f, "\nmisses: {}", self.misses.len())?;
        self.misses
            .iter()
            .try_for_each(|miss| writeln!(f, "  {miss}"))
    }
}
