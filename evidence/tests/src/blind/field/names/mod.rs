//! Comparison of the effects that the diagnosis names on field rigs with the sealed answers: gates with exact limits,
//! tables, every miss.

mod kept;
mod report;
#[cfg(test)]
mod tests;

use super::super::format::{Folders, Hidden};
use super::super::score::finding::{Finding, Fitted};
use super::super::score::judge::Judgement;
use super::super::score::{ScoreError, answers, found};
use super::finding::{Estimated, WithEffects, Worst};
use super::format::FieldAnswer;
use super::score::seconds;
use super::thresholds::*;
use crate::reference_plant::catalogue::Kinship;
pub use kept::Kept;
pub use report::NamesReport;

/// Rig with the effects that were named on it.
#[derive(Debug, Clone)]
pub struct NamedRig {
    /// Answer, the effect with the largest removal cost first.
    answer: FieldAnswer,
    /// Refinement of the first plant file; `None` if it did not end.
    refined: Option<Estimated>,
    /// Diagnosis with the refined plant; `None` if it did not end.
    finding: Option<Finding>,
    /// Refinement with the named effects; `None` if no effect is named, or if it did not end.
    fitted: Option<WithEffects>,
    /// Time of the diagnosis (s).
    seconds: Option<f64>,
    judgement: Judgement,
    /// Name that stands for each hidden effect.
    names: Vec<Option<String>>,
}

/// Hidden effect of a rig.
#[derive(Debug, Clone, Copy)]
struct OfRig<'a> {
    hidden: &'a Hidden,
    /// Removal cost in the signal with the largest one (noise floors).
    cost: f64,
    /// Whether it has to be named: the library has it, and its removal cost is large enough.
    is_asked: bool,
    is_named: bool,
}

/// Interval of a library parameter of a named effect.
#[derive(Debug, Clone, Copy)]
struct Interval<'a> {
    fitted: &'a Fitted,
    truth: f64,
}

impl NamedRig {
    /// Creates a rig with its findings.
    pub fn new(
        mut answer: FieldAnswer,
        refined: Option<Estimated>,
        finding: Option<Finding>,
        fitted: Option<WithEffects>,
        seconds: Option<f64>,
    ) -> Self {
        let costs = answer.clone();
        let cost = |hidden: &Hidden| costs.removal_cost(&hidden.effect);
        // A name that may stand for either of two effects stands for the one with the larger cost.
        answer.hidden.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
        let named = finding.as_ref().map(Finding::named).unwrap_or_default();
        let names = named.assigned(&answer.hidden).into_iter();
        Self {
            judgement: Judgement::new(&answer.hidden, &named),
            names: names.map(|name| name.map(str::to_owned)).collect(),
            answer,
            refined,
            finding,
            fitted,
            seconds,
        }
    }

    fn hidden(&self) -> impl Iterator<Item = OfRig<'_>> {
        let hidden = self.answer.hidden.iter().zip(&self.names);
        hidden.map(|(hidden, name)| {
            let cost = self.answer.removal_cost(&hidden.effect);
            OfRig {
                hidden,
                cost,
                is_asked: hidden.is_in_library() && cost >= ASKED_COST_MIN_FLOORS,
                is_named: name.is_some(),
            }
        })
    }

    fn hides_nothing(&self) -> bool {
        self.answer.hidden.is_empty()
    }

    fn is_all_in_library(&self) -> bool {
        self.answer.hidden.iter().all(Hidden::is_in_library)
    }

    fn has_false_name(&self) -> bool {
        self.hides_nothing() && self.judgement.named > 0
    }

    fn has_wrong_name(&self) -> bool {
        !self.hides_nothing() && self.judgement.wrong() > 0
    }

    /// Returns the free-run check error of the plant with the named effects, or of the refined plant if none is named
    /// (noise floors).
    fn free_run(&self) -> Option<Worst> {
        if self.finding.as_ref()?.effects.is_empty() {
            let refined = self.refined.as_ref()?;
            refined.free_run(refined)
        } else {
            self.fitted.as_ref()?.free_run()
        }
    }

    fn runs_free(&self) -> bool {
        self.free_run()
            .is_some_and(|worst| worst.floors <= NAMED_FREE_RUN_MAX_FLOORS)
    }

    fn has_few_effects(&self) -> bool {
        self.answer.hidden.len() <= FEW_EFFECTS
    }

    fn is_in_time(&self) -> bool {
        let most = if self.has_few_effects() {
            FEW_EFFECTS_TIME_MAX
        } else {
            MANY_EFFECTS_TIME_MAX
        };
        self.seconds
            .is_some_and(|seconds| seconds <= most.as_secs_f64())
    }

    /// Returns the intervals of the named effects whose law is the library's.
    fn intervals(&self) -> Vec<Interval<'_>> {
        let hidden = self.answer.hidden.iter();
        let matched = hidden.filter(|hidden| hidden.kinship == Kinship::Matched);
        matched
            .filter_map(|hidden| self.finding.as_ref()?.size_of(hidden))
            .map(|(fitted, truth)| Interval { fitted, truth })
            .collect()
    }

    /// Returns all misses.
    fn misses(&self) -> Vec<String> {
        if self.finding.is_none() {
            return vec!["no answer".to_owned()];
        }
        let mut misses = Vec::new();
        for missed in self.hidden().filter(|one| one.is_asked && !one.is_named) {
            misses.push(format!("{} not named", missed.hidden.effect));
        }
        if self.judgement.wrong() > 0 {
            misses.push(format!("{} wrong", count(self.judgement.wrong(), "name")));
        }
        for Interval { fitted, truth } in self.intervals() {
            if !fitted.contains(truth) {
                misses.push(format!(
                    "{} {:.3e} to {:.3e}, truly {truth:.3e}",
                    fitted.key, fitted.low, fitted.high
                ));
            }
        }
        if self.is_all_in_library() && !self.runs_free() {
            misses.push(self.free_run().map_or_else(
                || "free run not known".to_owned(),
                |worst| format!("free run {:.2} floors of {}", worst.floors, worst.signal),
            ));
        }
        if !self.is_in_time() {
            misses.push("too slow".to_owned());
        }
        misses
    }

    /// Returns one line on a rig with a miss.
    fn miss(&self) -> Option<String> {
        let misses = self.misses();
        if misses.is_empty() {
            return None;
        }
        let hidden: Vec<String> = self.hidden().map(|one| self.in_words(one.hidden)).collect();
        let (verdict, named, error) = self.finding.as_ref().map_or_else(
            || ("none", String::new(), f64::NAN),
            |finding| {
                let named = finding.effects.join(", ");
                (finding.verdict.as_str(), named, finding.last_over_floor())
            },
        );
        Some(format!(
            "{} ({}): hides [{}], named [{named}], verdict {verdict}, check error {error:.2} floors, {:.0} s: {}",
            self.answer.rig,
            self.answer.kind(),
            hidden.join(", "),
            self.seconds.unwrap_or(f64::NAN),
            misses.join("; ")
        ))
    }

    /// Returns a hidden effect with its law and its removal costs (noise floors).
    fn in_words(&self, hidden: &Hidden) -> String {
        let costs = self.answer.cost_if_left_out.get(&hidden.effect);
        let costs: String = costs
            .into_iter()
            .flatten()
            .map(|(signal, cost)| format!(" {signal} {cost:.1}"))
            .collect();
        let beyond = if hidden.is_in_library() {
            ""
        } else {
            ", not in the library"
        };
        format!("{} ({}{beyond}):{costs}", hidden.effect, hidden.law)
    }
}

fn count(number: usize, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{plural}")
}

/// Reads answers and findings of a draw, and scores the named effects. `better` are draws of the same rigs with better sensors, which
/// should keep the names.
///
/// # Errors
/// Returns an error if an answer or a finding cannot be read. A rig without a finding has no names, and the score as a
/// whole fails.
pub fn score(folders: &Folders, better: &[Folders]) -> Result<NamesReport, ScoreError> {
    let rigs = named_rigs(folders)?;
    let mut report = NamesReport::new(&rigs);
    for better in better {
        report.kept.push(Kept::of(&rigs, &named_rigs(better)?));
    }
    Ok(report)
}

fn named_rigs(folders: &Folders) -> Result<Vec<NamedRig>, ScoreError> {
    let (refined, named, fitted) = (folders.found(), folders.named(), folders.fitted());
    let seconds = seconds(&named)?;
    let rigs = answers::<FieldAnswer>(folders)?.into_iter().map(|answer| {
        let rig = answer.rig.clone();
        Ok(NamedRig::new(
            answer,
            found(&refined.finding(&rig))?,
            found(&named.finding(&rig))?,
            found(&fitted.finding(&rig))?,
            seconds.get(&rig).copied(),
        ))
    });
    rigs.collect()
}
