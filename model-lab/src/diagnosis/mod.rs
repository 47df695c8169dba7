//! Which physical effect is missing?
//!
//! ```text
//! logs ─► evidence (errors over the noise, seen through a predictor) ─► fit (nuisance parameters within their
//!         tolerances, with every effect) ─► search (all effects, all forms) ─► ladder (verdict) ─► result
//! ```

mod assemble;
mod detection;
mod error;
mod errors;
mod evidence;
mod fit;
mod gather;
mod interval;
mod ladder;
mod log;
pub mod next_experiment;
mod nuisance;
mod predictor;
mod refine;
mod remaining;
pub mod result;
mod search;
mod sensor_noise;
mod soundness;
mod start;
mod supply;
#[cfg(test)]
mod tests;
mod trial;
mod unknowns;
mod vector;
mod verdict;
mod view;

use std::time::Instant;

use plant_sim::PlantParameters;
use plant_sim::effects::{Effect, LIBRARY};
use rayon::prelude::*;
use recording::Recording;

pub use error::DiagnoseError;
pub use refine::{FittedEffect, REFINEMENT_SCHEMA, Refined, Refinement, refine};
pub use remaining::MissingFlow;
pub use result::Diagnosis;
pub use search::{Progress, Watch};

use gather::{fitting_and_checking, gather, held_out};
use result::{Cost, DIAGNOSIS_SCHEMA, Location, Remaining};
use trial::Bench;

/// Which effects of the library does `plant` lack to explain `logs`? What is held out judges: `check`, or without it,
/// blocks of the logs.
///
/// `watch` sees the progress and may stop the search.
///
/// # Errors
/// [`DiagnoseError`]: a log cannot be used, or `watch` stopped it.
pub fn diagnose(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<Diagnosis, DiagnoseError> {
    diagnose_with(&LIBRARY, plant, logs, check, watch)
}

/// As [`diagnose`], with a library of your own: more effects than ours, or fewer.
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
    let begin = Instant::now();
    let first = logs.first().ok_or(DiagnoseError::NoLog)?;
    let [fitting, checking] = fitting_and_checking(plant, logs, check)?;
    let mut bench = Bench {
        plant,
        library,
        fitting: &fitting,
        checking: &checking,
    };
    let not_simulated = || DiagnoseError::NotSimulated {
        log: first.provenance().source.clone(),
    };
    search::report(watch, "the plain model", 0.0)?;
    let mut plain = bench.plain().ok_or_else(not_simulated)?;
    let is_exchanged = plain.shows_only_where_not_fitted();
    if is_exchanged {
        core::mem::swap(&mut bench.fitting, &mut bench.checking);
        plain = bench.plain().ok_or_else(not_simulated)?;
    }
    let mut found = ladder::climb(&bench, plain, watch)?;
    let last = found.steps.last_mut().expect("at least the plain plant");
    search::report(watch, "the final fit", 0.0)?;
    last.polish(&bench).ok_or_else(not_simulated)?;

    let (plain, last) = (&found.steps[0], &found.steps[found.steps.len() - 1]);
    search::report(watch, "detection limits", 0.0)?;
    let candidates: Vec<_> = found
        .singles
        .par_iter()
        .map(|tried| assemble::candidate(&bench, plain, last, tried))
        .collect();
    search::report(watch, "where the error is", 0.0)?;
    let before = assemble::regimes(&plain.plant(), logs)?;
    let after = if found.steps.len() > 1 {
        assemble::regimes(&last.plant(), logs)?
    } else {
        before.clone()
    };
    let unfitted = if check.is_empty() {
        &[]
    } else {
        &checking.logs[..]
    };
    let logs_seen: Vec<_> = fitting.logs.iter().chain(unfitted).collect();
    let remaining = remaining::remaining(&last.plant(), &logs_seen, last.is_material());
    let ladder = assemble::ladder(&bench, &found)?;
    let (equivalents, distinguishability) = assemble::equivalents(&found);
    let elapsed_s = begin.elapsed().as_secs_f64();
    let simulations = bench.fitting.simulations() + bench.checking.simulations();
    let sources = |logs: &[Recording]| -> Vec<String> {
        let names = logs.iter().map(|log| log.provenance().source.clone());
        names.collect()
    };
    let [mut fitted, mut judged] = [sources(logs), sources(check)];
    if is_exchanged && !check.is_empty() {
        core::mem::swap(&mut fitted, &mut judged);
    }
    Ok(Diagnosis {
        schema: DIAGNOSIS_SCHEMA.to_owned(),
        logs: fitted,
        check: judged,
        held_out: held_out(!check.is_empty(), is_exchanged).to_owned(),
        predictor: predictor::STATEMENT.to_owned(),
        verdict: found.verdict(),
        sentence: assemble::sentence(found.verdict(), &ladder, &candidates, &equivalents),
        effects: ladder
            .iter()
            .filter_map(|step| step.added.clone())
            .collect(),
        unexplained: found.is_unexplained(),
        equivalents,
        distinguishability,
        nuisance: assemble::nuisance(&bench, plain, last),
        ladder,
        candidates,
        location: Location { before, after },
        remaining,
        cost: Cost {
            simulations,
            log_s: fitting.duration_s(),
            elapsed_s,
            per_simulation_ms: fitting.computing_s() / fitting.simulations().max(1) as f64 * 1e3,
        },
    })
}

/// What remains of the errors of `plant` on `logs` when its nuisance parameters and the effects that it has are fitted,
/// without a search for missing effects.
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
