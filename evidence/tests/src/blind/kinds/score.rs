//! Comparison of the diagnoses with the answers: one line for each rig.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;

use super::super::format::{Folders, Stage};
use super::super::score::finding::Finding;
use super::super::score::{ScoreError, answers, found};
use super::format::KindAnswer;

/// Verdict that nothing is missing.
const ADEQUATE: &str = "adequate";

/// Correctness of the names of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Names {
    /// Every hidden effect is named, and nothing else.
    Right,
    /// Some hidden effects are named, and nothing else.
    InPart,
    /// A name stands for no hidden effect.
    Wrong,
    /// No effect is named, though the rig hides some.
    Missed,
    /// Nothing is hidden and nothing is named, but the verdict says that physics is missing or the plant file is wrong.
    FalseAlarm,
    /// There is no finding.
    None,
}

impl fmt::Display for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Right => "right",
            Self::InPart => "in part",
            Self::Wrong => "wrong",
            Self::Missed => "missed",
            Self::FalseAlarm => "false alarm",
            Self::None => "no finding",
        })
    }
}

/// Rig with its finding.
#[derive(Debug, Clone)]
pub struct ScoredKind {
    /// Answer.
    pub answer: KindAnswer,
    /// Result of the diagnosis; `None` if it did not end.
    pub finding: Option<Finding>,
    /// Time (s) and exit status of the last run.
    pub run: Option<(f64, i32)>,
}

impl ScoredKind {
    /// Returns the correctness of the names. A name also stands for the effects that the diagnosis cannot distinguish
    /// from it.
    pub fn names(&self) -> Names {
        let Some(finding) = &self.finding else {
            return Names::None;
        };
        let stands = |name: &String, hidden: &String| {
            let equivalents = finding.equivalents.get(name);
            name == hidden || equivalents.is_some_and(|ids| ids.contains(hidden))
        };
        let mut left: Vec<&String> = self.answer.effects.keys().collect();
        for name in &finding.effects {
            match left.iter().position(|hidden| stands(name, hidden)) {
                Some(place) => drop(left.remove(place)),
                None => return Names::Wrong,
            }
        }
        if self.answer.effects.is_empty() && finding.verdict != ADEQUATE {
            Names::FalseAlarm
        } else if left.is_empty() {
            Names::Right
        } else if finding.effects.is_empty() {
            Names::Missed
        } else {
            Names::InPart
        }
    }
}

/// Table of all rigs of a draw.
#[derive(Debug, Clone)]
pub struct KindsReport(Vec<ScoredKind>);

/// Reads answers and findings of a draw.
///
/// # Errors
/// Returns an error if an answer or a finding cannot be read.
pub fn score(folders: &Folders) -> Result<KindsReport, ScoreError> {
    let runs = runs(&folders.found())?;
    let rigs = answers::<KindAnswer>(folders)?.into_iter().map(|answer| {
        Ok(ScoredKind {
            finding: found(&folders.found().finding(&answer.rig))?,
            run: runs.get(&answer.rig).copied(),
            answer,
        })
    });
    Ok(KindsReport(rigs.collect::<Result<_, ScoreError>>()?))
}

/// Returns time (s) and exit status of the last command of each rig.
fn runs(stage: &Stage) -> Result<BTreeMap<String, (f64, i32)>, ScoreError> {
    let times = stage.times();
    if !times.exists() {
        return Ok(BTreeMap::new());
    }
    let text = fs::read_to_string(&times).map_err(|error| ScoreError::Read(times, error))?;
    let runs = text.lines().filter_map(|line| {
        let mut cells = line.split(',');
        let rig = cells.next()?.to_owned();
        let seconds = cells.next()?.parse().ok()?;
        Some((rig, (seconds, cells.next()?.parse().ok()?)))
    });
    Ok(runs.collect())
}

impl KindsReport {
    /// Returns whether every rig has the right names.
    pub fn holds(&self) -> bool {
        self.0.iter().all(|rig| rig.names() == Names::Right)
    }
}

impl fmt::Display for KindsReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "rig      kind            names        explained  status    s  hidden (cost in noise floors)  ->  named"
        )?;
        self.0.iter().try_for_each(|rig| line(f, rig))?;
        let names = [
            Names::Right,
            Names::InPart,
            Names::Wrong,
            Names::Missed,
            Names::FalseAlarm,
            Names::None,
        ];
        let counts = names.map(|names| {
            let count = self.0.iter().filter(|rig| rig.names() == names).count();
            format!("{names} {count}")
        });
        writeln!(f, "{} rigs: {}", self.0.len(), counts.join(", "))
    }
}

fn line(f: &mut fmt::Formatter<'_>, rig: &ScoredKind) -> fmt::Result {
    let answer = &rig.answer;
    let hidden = answer.effects.keys();
    let hidden: Vec<String> = hidden
        .map(|effect| format!("{effect} {:.1}", answer.cost(effect)))
        .collect();
    let finding = rig.finding.as_ref();
    let share = finding.and_then(|finding| finding.error_steps.last()?.explained_share);
    let explained = share.map_or("-".to_owned(), |share| format!("{:.0} %", 100.0 * share));
    let (seconds, status) = rig.run.unzip();
    writeln!(
        f,
        "{}  {:14}  {:11}  {:>9}  {:>6}  {:>3.0}  {}  ->  {}",
        answer.rig,
        answer.kind,
        rig.names(),
        explained,
        status.map_or("-".to_owned(), |status| status.to_string()),
        seconds.unwrap_or(f64::NAN),
        listed(&hidden),
        finding.map_or("-".to_owned(), |finding| listed(&finding.effects)),
    )
}

fn listed(names: &[String]) -> String {
    if names.is_empty() {
        "nothing".to_owned()
    } else {
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::super::draw::{KindsDraw, Wishes};
    use super::*;

    #[test]
    fn names_are_right_in_part_wrong_or_missed() {
        let wishes = Wishes {
            effects: Some(2),
            lengths_s: Some([2.0, 2.0]),
            rate_hz: Some(100.0),
        };
        let answer = KindsDraw::new(1, 1, wishes).rig(1).answer;
        let hidden: Vec<String> = answer.effects.keys().cloned().collect();
        let said = |effects: &[&str], equivalents: &str| {
            let finding = format!(
                r#"{{"verdict": "found", "effects": {effects:?}, "equivalents": {equivalents}, "error_steps": []}}"#
            );
            let scored = ScoredKind {
                answer: answer.clone(),
                finding: Some(serde_json::from_str(&finding).unwrap()),
                run: None,
            };
            scored.names()
        };
        let [first, second] = [&hidden[0], &hidden[1]];
        assert_eq!(said(&[second, first], "{}"), Names::Right);
        assert_eq!(said(&[second], "{}"), Names::InPart);
        assert_eq!(said(&[], "{}"), Names::Missed);
        assert_eq!(said(&[first, "dead_volume"], "{}"), Names::Wrong);
        let equivalents = format!(r#"{{"dead_volume": ["dead_volume", "{second}"]}}"#);
        assert_eq!(said(&[first, "dead_volume"], &equivalents), Names::Right);
    }

    #[test]
    fn a_plain_rig_without_a_name_is_right_only_if_nothing_is_said_to_be_missing() {
        let wishes = Wishes {
            effects: Some(0),
            lengths_s: Some([2.0, 2.0]),
            rate_hz: Some(100.0),
        };
        let answer = KindsDraw::new(1, 1, wishes).rig(1).answer;
        for (verdict, names) in [
            (ADEQUATE, Names::Right),
            ("plant_file_wrong", Names::FalseAlarm),
            ("not_in_library", Names::FalseAlarm),
        ] {
            let finding =
                format!(r#"{{"verdict": "{verdict}", "effects": [], "error_steps": []}}"#);
            let scored = ScoredKind {
                answer: answer.clone(),
                finding: Some(serde_json::from_str(&finding).unwrap()),
                run: None,
            };
            assert_eq!(scored.names(), names);
        }
    }
}
