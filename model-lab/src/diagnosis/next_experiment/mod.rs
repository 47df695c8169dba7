//! Cheapest next experiment: the duty cycles that distinguish rival effects, and if none do, the sensor that would.
//!
//! Every rival is fitted to the logs. Each excitation is simulated with one rival as the truth and fitted with the other, with all free
//! parameters, as far as the old logs admit. The remaining difference, in standard deviations of the noise, is the distance (W. G. Hunter,
//! A. M. Reiner 1965). The smaller of both directions counts.

mod assemble;
mod determine;
mod determine_result;
#[cfg(test)]
mod determine_tests;
mod distance;
mod driver;
mod result;
mod sensors;
mod test_signal;
#[cfg(test)]
mod tests;

use core::cmp::Ordering;

use plant_sim::PlantParameters;
use plant_sim::effects::EffectSetting;
use plant_sim::parameters::Part;
use plant_sim::plant::{FILL, VENT};
use rayon::prelude::*;
use recording::Recording;

use super::error::{DiagnoseError, candidate};
use super::evidence::logged_supply::with_logged_supply;
use super::fit::gather::gather;
use super::fit::trial::{Bench, Trial};
use super::search::{Watch, best_form, report};
use distance::{Noises, Rival, Unseen, distance};
use test_signal::Sequence;

pub use determine::determining_experiment;
pub use determine_result::{
    DETERMINING_EXPERIMENT_SCHEMA, DeterminingExperiment, DeterminingTestSignal, ForeseenParameter,
};
pub use result::{
    Limits, NEXT_EXPERIMENT_SCHEMA, NextExperiment, Phase, RivalEffect, Sensor, TestSignal,
};

/// Purpose of the experiment.
#[derive(Debug, Clone, Copy)]
pub enum Question<'a> {
    /// Distinction of two or more effects, by their ids.
    Between(&'a [&'a str]),
    /// Detection of an effect of typical size, if it exists.
    For(&'a str),
}

/// Ranks excitations within `limits` by how well they answer `question`, given the information in `logs` of `plant`.
///
/// # Errors
/// [`DiagnoseError`]: the plant lacks a valve or the chamber, a log cannot be used, there is no such effect, no excitation satisfies the
/// limits or can be simulated, or `watch` stopped the search.
pub fn next_experiment(
    plant: &PlantParameters,
    logs: &[Recording],
    question: Question,
    limits: Limits,
    watch: Watch,
) -> Result<NextExperiment, DiagnoseError> {
    let first = logs.first().ok_or(DiagnoseError::NoLog)?;
    check_parts(plant)?;
    let plant = &with_logged_supply(plant, logs);
    let fitting = gather(plant, logs)?;
    let bench = Bench {
        library: &[],
        plant,
        fitting: &fitting,
        checking: &fitting,
    };
    report(watch, "the plain model", 0.0)?;
    let plain = bench.plain().ok_or_else(|| DiagnoseError::NotSimulated {
        log: first.provenance().source.clone(),
    })?;
    let rivals = match question {
        Question::Between(ids) => fitted(&bench, &plain, ids, watch)?,
        Question::For(id) => typical(&bench, &plain, id)?,
    };
    let now = match question {
        Question::Between(_) => pairs(&rivals)
            .map(|(a, b)| distance::on_the_logs(a, b))
            .fold(f64::INFINITY, f64::min),
        Question::For(_) => 0.0,
    };
    let noises = Noises::of(&fitting);
    let plants: Vec<_> = rivals.iter().map(|rival| &rival.plant).collect();
    let sequences = test_signal::sequences(&plants, &limits)?;
    report(watch, "test signals", 0.0)?;
    let distance_on = |sequence: &Sequence| {
        let between = |a: &Rival, b: &Rival| distance(a, b, sequence, &noises);
        match question {
            Question::Between(_) => pairs(&rivals).try_fold(f64::INFINITY, |least, (a, b)| {
                Ok(least.min(between(a, b)?).min(between(b, a)?))
            }),
            Question::For(_) => between(&rivals[1], &rivals[0]),
        }
    };
    let ranked = ranked(sequences, watch, distance_on, falling);
    let ranked = ranked.map_err(|none| none.error(&rivals, &noises))?;
    let sensors = sensors::sensors(&rivals, &ranked[0].0, &fitting);
    Ok(assemble::assemble(
        fitting.sources(),
        &rivals,
        limits,
        now,
        ranked,
        sensors,
    ))
}

/// Checks that the plant has the parts that every excitation uses: both valves and the chamber.
fn check_parts(plant: &PlantParameters) -> Result<(), DiagnoseError> {
    let parts = [
        Part::CommandedValve(FILL),
        Part::CommandedValve(VENT),
        Part::Chamber,
    ];
    match parts.into_iter().find(|part| !part.is_in(plant)) {
        Some(part) => Err(DiagnoseError::PartLeftOut { part }),
        None => Ok(()),
    }
}

/// Returns the excitations with their values, the best first by `order`. One without a value is left out, since a missing value is not 0.
fn ranked<T: Send>(
    sequences: Vec<Sequence>,
    watch: Watch,
    worth: impl Fn(&Sequence) -> Result<T, Unseen> + Sync,
    order: impl Fn(&T, &T) -> Ordering,
) -> Result<Vec<(Sequence, T)>, NoneRanked> {
    let test_signals = sequences.len();
    let tried = sequences
        .into_par_iter()
        .map(|sequence| {
            let worth = worth(&sequence);
            report(watch, "test signals", 0.5).map_err(NoneRanked::Stopped)?;
            Ok(worth.map(|worth| (sequence, worth)))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let is_unshown = tried
        .iter()
        .any(|tried| matches!(tried, Err(Unseen::NotShown)));
    let mut ranked: Vec<_> = tried.into_iter().flatten().collect();
    if ranked.is_empty() {
        return Err(if is_unshown {
            NoneRanked::NotShown
        } else {
            NoneRanked::NotSimulated { test_signals }
        });
    }
    ranked.sort_by(|a, b| order(&a.1, &b.1));
    Ok(ranked)
}

/// Orders the larger first.
fn falling(a: &f64, b: &f64) -> Ordering {
    b.total_cmp(a)
}

/// Reason why no excitation is ranked.
#[derive(Debug, Clone, PartialEq)]
enum NoneRanked {
    /// The search was stopped.
    Stopped(DiagnoseError),
    /// No excitation can be simulated.
    NotSimulated { test_signals: usize },
    /// The signals of the logs do not show the change due to a rival.
    NotShown,
}

impl NoneRanked {
    fn error(self, rivals: &[Rival], noises: &Noises) -> DiagnoseError {
        match self {
            Self::Stopped(error) => error,
            Self::NotSimulated { test_signals } => {
                DiagnoseError::NoTestSignalSimulated { test_signals }
            }
            Self::NotShown => {
                let ids = rivals.iter().filter_map(|rival| rival.effect.as_ref());
                DiagnoseError::NoTestSignalShows {
                    effects: ids.map(|(id, _)| id.clone()).collect(),
                    logged: noises.signals().map(str::to_owned).collect(),
                }
            }
        }
    }
}

/// Returns each pair of the rivals once.
fn pairs(rivals: &[Rival]) -> impl Iterator<Item = (&Rival, &Rival)> {
    rivals
        .iter()
        .enumerate()
        .flat_map(|(n, a)| rivals[..n].iter().map(move |b| (a, b)))
}

fn settings(plant: &PlantParameters, id: &str) -> Result<Vec<EffectSetting>, DiagnoseError> {
    let effect = candidate(plant, id)?;
    let variants = effect.about().variants.iter();
    Ok(variants
        .map(|variant| EffectSetting::typical_variant(effect, variant))
        .collect())
}

/// Fits each effect on top of the plain model, in the form with most evidence.
fn fitted(
    bench: &Bench,
    plain: &Trial,
    ids: &[&str],
    watch: Watch,
) -> Result<Vec<Rival>, DiagnoseError> {
    let mut rivals = Vec::new();
    for id in ids {
        report(
            watch,
            "the rival effects",
            rivals.len() as f64 / ids.len() as f64,
        )?;
        let not_fitted = || DiagnoseError::NotFitted {
            id: (*id).to_owned(),
        };
        let mut best =
            best_form(bench, plain, settings(bench.plant, id)?).ok_or_else(not_fitted)?;
        best.refresh(bench).ok_or_else(not_fitted)?;
        rivals.push(Rival::of_trial(bench, best, Some(id)));
    }
    Ok(rivals)
}

/// Returns the plain model, and the plain model with the effect at its typical size.
fn typical(bench: &Bench, plain: &Trial, id: &str) -> Result<Vec<Rival>, DiagnoseError> {
    let setting = settings(bench.plant, id)?.swap_remove(0);
    let without = Rival::of_trial(bench, plain.clone(), None);
    let with = without.with(setting);
    Ok(vec![without, with])
}
