//! Comparison of the diagnoses with the sealed answers: shares with limits, gates, misses, and simple rules for
//! comparison.

pub mod finding;
pub(super) mod gate;
pub(super) mod judge;
mod log;
mod rules;
pub mod share;
mod sparse_regression;
mod table;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use thiserror::Error;

use super::format::{Answer, Class, Folders};
use finding::Finding;
pub use gate::{Gate, Quality};
use judge::{Judgement, Named};
pub use table::Report;

/// Upper ends of the strata of excess, in units of the noise; the last stratum is open.
pub const STRATA: [f64; 4] = [0.15, 0.5, 1.0, 3.0];
/// Minimum excess of an effect that has to be found, in units of the noise.
pub const TO_BE_FOUND: f64 = 0.5;

/// Reason why there is no score.
#[derive(Debug, Error)]
pub enum ScoreError {
    /// A file or a folder could not be read.
    #[error("{}: {}", .0.display(), .1)]
    Read(PathBuf, #[source] io::Error),
    /// A file does not have the expected form.
    #[error("{} is not what the score reads: {}", .0.display(), .1)]
    Form(PathBuf, #[source] serde_json::Error),
    /// There is nothing to score.
    #[error("no answer in {}; draw first", .0.display())]
    NoAnswers(PathBuf),
}

/// Rig with its answer and, if the diagnosis ended, its finding.
#[derive(Debug, Clone)]
pub struct Scored {
    /// Answer.
    pub answer: Answer,
    /// Result of the diagnosis.
    pub finding: Option<Finding>,
    /// For two hidden effects, the excess of a model with one of them alone; empty if it was not computed.
    alone: Vec<f64>,
    /// Correctness of its names.
    judgement: Judgement,
    /// Correctness of the simple rules' names, in the order of [`rules::RULES`].
    by_rules: Vec<Judgement>,
}

impl Scored {
    fn new(
        answer: Answer,
        finding: Option<Finding>,
        alone: Vec<f64>,
        log: Option<&log::Log>,
    ) -> Self {
        let named = finding.as_ref().map(Finding::named).unwrap_or_default();
        let judgement = Judgement::new(&answer.hidden, &named);
        let by_rules = rules::RULES
            .iter()
            .map(|rule| {
                let effects = (rule.names)(&answer, finding.as_ref(), log);
                let named = Named {
                    effects,
                    ..Named::default()
                };
                Judgement::new(&answer.hidden, &named)
            })
            .collect();
        Self {
            answer,
            finding,
            alone,
            judgement,
            by_rules,
        }
    }

    /// Returns the excess of the refitted plain model in units of the noise; `None` if the diagnosis did not end.
    pub fn excess(&self) -> Option<f64> {
        self.finding.as_ref().map(Finding::excess)
    }

    fn is_single(&self) -> bool {
        matches!(self.answer.class, Class::Matched | Class::Variant)
    }

    fn has_library_effects(&self) -> bool {
        self.is_single() || self.answer.class == Class::Two
    }

    /// Returns whether each of two effects is detectable beside the other one.
    fn is_separable(&self) -> bool {
        self.alone.len() == 2 && self.alone.iter().all(|&excess| excess >= TO_BE_FOUND)
    }

    /// Returns whether it has one detectable effect, or its diagnosis did not end.
    fn is_to_be_found(&self) -> bool {
        self.is_single() && self.excess().is_none_or(|excess| excess >= TO_BE_FOUND)
    }
}

/// Reads answers and findings of a draw, and scores them.
///
/// # Errors
/// Returns an error if an answer or a finding cannot be read. A rig without a finding has no names.
pub fn score(folders: &Folders) -> Result<Report, ScoreError> {
    let rigs = answers::<Answer>(folders)?.into_iter().map(|answer| {
        let finding = found(&folders.found().finding(&answer.rig))?;
        let alone = alone(folders, &answer)?;
        let log = log::Log::read(&folders.id_log(&answer.rig))?;
        Ok(Scored::new(answer, finding, alone, Some(&log)))
    });
    let rigs: Vec<Scored> = rigs.collect::<Result<_, ScoreError>>()?;
    Ok(Report::new(&rigs))
}

/// Returns the excess without each of two effects, if it was computed.
fn alone(folders: &Folders, answer: &Answer) -> Result<Vec<f64>, ScoreError> {
    if answer.class != Class::Two {
        return Ok(Vec::new());
    }
    let hidden = answer.hidden.iter();
    let paths = hidden.map(|hidden| folders.alone_with(&answer.rig, &hidden.effect));
    let there = paths.filter(|path| path.exists());
    there
        .map(|path| Ok(parse::<finding::Alone>(&path)?.excess()))
        .collect()
}

/// Returns the answers of a draw, in the order of their rigs.
pub(super) fn answers<T: DeserializeOwned>(folders: &Folders) -> Result<Vec<T>, ScoreError> {
    let sealed = folders.sealed();
    let read = fs::read_dir(&sealed).map_err(|error| ScoreError::Read(sealed.clone(), error))?;
    let mut paths: Vec<PathBuf> = read
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .collect();
    paths.sort();
    if paths.is_empty() {
        return Err(ScoreError::NoAnswers(sealed));
    }
    paths.iter().map(|path| parse(path)).collect()
}

/// Reads a file; `None` if it does not exist.
pub(super) fn found<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, ScoreError> {
    path.exists().then(|| parse(path)).transpose()
}

pub(super) fn parse<T: DeserializeOwned>(path: &Path) -> Result<T, ScoreError> {
    let text =
        fs::read_to_string(path).map_err(|error| ScoreError::Read(path.to_owned(), error))?;
    serde_json::from_str(&text).map_err(|error| ScoreError::Form(path.to_owned(), error))
}
