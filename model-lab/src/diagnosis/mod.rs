//! Search for the missing physical effect.
//!
//! ```text
//! logs ─► evidence (errors over the noise, seen through a predictor) ─► fit (clocks, and nuisance parameters within
//!         their tolerances) ─► search (these tolerances widened, or all effects in all forms) ─► result
//! ```
//!
//! A group uses only groups to its left, and the types of `result`.

mod error;
mod estimation;
mod evidence;
#[cfg(test)]
mod field_tests;
mod fit;
#[cfg(test)]
mod found_tests;
mod knowledge;
mod known;
pub mod next_experiment;
mod nuisance;
#[cfg(test)]
mod own_effect_tests;
mod refine;
mod remaining;
pub mod result;
mod search;
mod second_look;
#[cfg(test)]
mod start_tests;
#[cfg(test)]
mod tests;
mod verdict;

use std::time::Instant;

use plant_sim::PlantParameters;
use plant_sim::effects::{Effect, EffectSetting};
use rayon::prelude::*;
use recording::Recording;

pub use error::DiagnoseError;
pub use estimation::{
    Determination, ESTIMATION_SCHEMA, EstimatedParameter, EstimatedPlant, Estimation, estimate,
};
pub(crate) use fit::logger_time::conditions_of;
pub use knowledge::{KnowledgeError, fix, free};
pub use known::{Known, asking_plant_file, known};
pub use refine::{FittedEffect, REFINEMENT_SCHEMA, Refined, Refinement, refine};
pub use remaining::MissingFlow;
pub use result::Diagnosis;
pub use search::{Progress, Watch};

use evidence::logged_supply::with_logged_supply;
use evidence::predictor;
use fit::gather::gather;
use fit::split::Split;
use fit::trial::Bench;
use result::{DIAGNOSIS_SCHEMA, Location, Remaining};
use search::{assemble, found};

/// Finds the effects that `plant` lacks to explain `logs`: those of the library, and the user-defined ones of the plant file. Validation uses `check`, or without it, held-out blocks of the
/// logs.
///
/// `watch` receives the progress and may stop the search.
///
/// # Errors
/// [`DiagnoseError`]: a log cannot be used, or `watch` stopped it.
pub fn diagnose(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<Diagnosis, DiagnoseError> {
    let candidates: Vec<_> = plant.candidates().collect();
    diagnose_with(&candidates, plant, logs, check, watch)
}

/// Diagnoses as [`diagnose`] does, with another library: more effects than the built-in one, or fewer.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_with(
    library: &[&'static dyn Effect],
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<Diagnosis, DiagnoseError> {
    let first = diagnose_within(library, plant, logs, check, watch)?;
    if !first.is_held_back {
        return Ok(first.diagnosis);
    }
    let with_found = first.found.iter().cloned();
    let with_found = with_found.fold(plant.clone(), |plant, effect| plant.with_effect(effect));
    let EstimatedPlant {
        plant: mut estimated,
        estimation,
    } = estimate(&with_found, logs, check, watch)?;
    let mut first = first.diagnosis;
    let is_nearer = second_look::is_nearer(&estimation, &first);
    first.cost.add(&estimation.cost);
    if !is_nearer {
        return Ok(first);
    }
    estimated = first
        .effects
        .iter()
        .fold(estimated, |plant, id| plant.without_effect(id));
    let second = diagnose_within(library, &estimated, logs, check, watch)?.diagnosis;
    let mut cost = first.cost.clone();
    cost.add(&second.cost);
    let second = second_look::relative_to_file(plant, &first, second);
    Ok(Diagnosis {
        cost,
        ..second.unwrap_or(first)
    })
}

/// Diagnosis within the ranges of the plant file, and the inputs of a second look.
struct Answer {
    diagnosis: Diagnosis,
    /// Named effects with their fitted parameters.
    found: Vec<EffectSetting>,
    /// Whether an error remains and ordinary parameters reached the ends of their ranges.
    is_held_back: bool,
}

/// Diagnoses within the ranges that `plant` states for its ordinary parameters.
fn diagnose_within(
    library: &[&'static dyn Effect],
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<Answer, DiagnoseError> {
    let begin = Instant::now();
    if logs.is_empty() {
        return Err(DiagnoseError::NoLog);
    }
    search::report(watch, "the plain model", 0.0)?;
    let plant = &with_logged_supply(plant, logs.iter().chain(check));
    let (mut split, plain) = Split::that_shows(plant, logs, check)?;
    // An effect of a part that the plant lacks has no form.
    let library: Vec<&'static dyn Effect> = library
        .iter()
        .copied()
        .filter(|&effect| !plant.forms_of(effect).is_empty())
        .collect();
    let mut found = found::find(&mut split, plant, &library, plain, watch)?;
    let mut adds_up = found.adds_up(&split.bench(plant, &library));
    if adds_up
        && let Some(free) = found::find_in_free_run(&mut split, plant, &library, &found, watch)?
    {
        (found, adds_up) = (free, false);
    }
    let bench = split.bench(plant, &library);
    let last = found.steps.last_mut().expect("at least the plain plant");
    search::report(watch, "the final fit", 0.0)?;
    last.polish(&bench).ok_or_else(|| split.not_simulated())?;
    let is_converged = last.is_converged(&bench);

    let (plain, last) = (&found.steps[0], &found.steps[found.steps.len() - 1]);
    search::report(watch, "detection limits", 0.0)?;
    let candidates: Vec<_> = found
        .singles
        .par_iter()
        .map(|tried| assemble::candidate(&bench, plain, last, tried))
        .collect();
    let error_steps = assemble::error_steps(&bench, &found);
    let within = found.within.as_ref().unwrap_or(plain);
    let nuisance = assemble::nuisance(&bench, within, last);
    let outside = assemble::outside(within, found.alternative.as_ref().unwrap_or(last));
    let (equivalents, distinguishability) = assemble::equivalents(&found);
    search::report(watch, "where the error is", 0.0)?;
    split.take_conditions(plain);
    let given = assemble::regimes(plant, (logs, &split.fitting.logs))?;
    let before = assemble::regimes(&plain.plant(), (logs, &split.fitting.logs))?;
    let after = if found.steps.len() > 1 {
        split.take_conditions(last);
        assemble::regimes(&last.plant(), (logs, &split.fitting.logs))?
    } else {
        before.clone()
    };
    let logs_seen: Vec<_> = split
        .fitting
        .logs
        .iter()
        .chain(split.check_logs())
        .collect();
    let remaining = remaining::remaining(&last.plant(), &logs_seen, last.is_material());
    let is_held_back = last.is_material() && last.unknowns.widened(&last.fit.z).is_some();
    let mut diagnosis = Diagnosis {
        schema: DIAGNOSIS_SCHEMA.to_owned(),
        logs: split.fitting.sources(),
        check: split.check_sources(),
        not_compared: split.not_compared(),
        defects: split.defects(),
        warnings: split.warnings(),
        clocks: split.clocks(),
        starts: split.starts(),
        held_out: split.held_out().to_owned(),
        horizon: split.horizon(),
        adds_up,
        predictor: predictor::statement(split.horizon()).to_owned(),
        verdict: found.verdict(),
        sentence: String::new(),
        is_converged,
        rival_effects: found.rival_effects(),
        effects: error_steps
            .iter()
            .filter_map(|step| step.added.clone())
            .collect(),
        unexplained: found.is_unexplained(),
        equivalents,
        distinguishability,
        nuisance,
        error_steps,
        outside,
        candidates,
        location: Location {
            of_compare: assemble::moved_by_refit(&given, &before),
            before,
            after,
        },
        remaining,
        cost: split.cost(begin),
    };
    diagnosis.sentence = assemble::sentence(&assemble::Answer::from(&diagnosis));
    let found = last.plant().effects;
    let is_found = |effect: &EffectSetting| diagnosis.effects.iter().any(|id| id == effect.id());
    Ok(Answer {
        found: found.into_iter().filter(is_found).collect(),
        diagnosis,
        is_held_back,
    })
}

/// Returns the unexplained residual of `plant` on `logs` after its nuisance parameters and its effects are fitted, without a search for
/// missing effects.
///
/// # Errors
/// [`DiagnoseError`]: a log cannot be used.
pub fn remaining(plant: &PlantParameters, logs: &[Recording]) -> Result<Remaining, DiagnoseError> {
    let first = logs.first().ok_or(DiagnoseError::NoLog)?;
    let fitting = gather(plant, logs)?;
    let bench = Bench {
        library: &[],
        plant,
        fitting: &fitting,
        checking: &fitting,
    };
    let plain = bench.plain().ok_or_else(|| DiagnoseError::NotSimulated {
        log: first.provenance().source.clone(),
    })?;
    let logs: Vec<_> = fitting.logs.iter().collect();
    Ok(remaining::remaining(
        &plain.plant(),
        &logs,
        plain.is_material(),
    ))
}
