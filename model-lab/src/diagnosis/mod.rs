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
mod refitted;
mod remaining;
pub mod result;
mod search;
#[cfg(test)]
mod start_tests;
#[cfg(test)]
mod tests;
mod verdict;
mod with_estimates;

use std::time::Instant;

use plant_sim::PlantParameters;
use plant_sim::effects::Effect;
use recording::Recording;

pub use error::DiagnoseError;
pub use estimation::{
    Determination, ESTIMATION_SCHEMA, EstimatedParameter, EstimatedPlant, Estimation, estimate,
};
pub(crate) use fit::logger_time::conditions_of;
pub use knowledge::{KnowledgeError, fix, free, state};
pub use known::{Known, asking_plant_file, known};
pub use refine::{FittedEffect, REFINEMENT_SCHEMA, Refined, Refinement};
pub use remaining::{MissingFlow, WithMissingFlow};
pub use result::Diagnosis;
pub use search::{Progress, Watch, WorstError};

use fit::gather::gather;
use fit::trial::Bench;
use result::{Cost, Remaining};
use with_estimates::Inputs;

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
    let begin = Instant::now();
    let lag_of = estimation::lag_of_logs(plant, logs, check, watch)?;
    let inputs = Inputs {
        library,
        plant: &plant.with_lag_of(lag_of),
        logs,
        check,
        watch,
    };
    let mut costs = Vec::new();
    let mut diagnosis = inputs.diagnose(&mut costs)?;
    diagnosis.lag_of = lag_of.map(|lag_of| lag_of.word().to_owned());
    diagnosis.cost = Cost::sum(&costs, begin.elapsed().as_secs_f64());
    Ok(diagnosis)
}

/// Adds the effects of `add` (id, and the form of the law or none for the one that fits best) to `plant` and fits them to `logs` together
/// with the nuisance parameters. Validation uses `check`, or without it, held-out blocks of the logs.
///
/// An effect that the plant already has is fitted again.
///
/// # Errors
/// [`DiagnoseError`]: an effect or a form does not exist, a log cannot be used, or `watch` stopped the fit.
pub fn refine(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    add: &[(String, Option<String>)],
    watch: Watch,
) -> Result<Refined, DiagnoseError> {
    let lag_of = estimation::lag_of_logs(plant, logs, check, watch)?;
    refine::refine(&plant.with_lag_of(lag_of), logs, check, add, watch)
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
