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
mod second_look;
#[cfg(test)]
mod start_tests;
#[cfg(test)]
mod tests;
mod verdict;

use plant_sim::PlantParameters;
use plant_sim::effects::Effect;
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

use fit::gather::gather;
use fit::trial::Bench;
use refitted::Refitted;
use result::{Remaining, Verdict};
use search::found::Extent;
use second_look::SecondLook;

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
    let look = SecondLook {
        library,
        plant,
        logs,
        check,
        watch,
    };
    let mut refitted = Refitted::fit(plant, logs, check, watch)?;
    let mut beyond = None;
    if refitted.is_material() && second_look::may_be_first_file(plant) {
        let estimated = estimation::for_search(plant, logs, check, watch)?;
        if second_look::is_promising(plant, &estimated.estimation) {
            let single = refitted.search(library, Extent::One, watch)?.diagnosis;
            if single.verdict != Verdict::Found {
                let is_far_nearer = second_look::is_far_nearer(&estimated.estimation, &single);
                let mut second = look.at(estimated, &single)?;
                second.cost.add(&single.cost);
                if second_look::is_final(&second, is_far_nearer) {
                    return Ok(second);
                }
                beyond = Some(second);
            }
            refitted = Refitted::fit(plant, logs, check, watch)?;
        }
    }
    let first = refitted.search(library, Extent::All, watch)?;
    if let Some(second) = beyond {
        return Ok(first.or(second));
    }
    if !first.is_held_back {
        return Ok(first.diagnosis);
    }
    let with_found = first.plant_with_found(plant);
    let mut estimated = estimation::for_search(&with_found, logs, check, watch)?;
    if !second_look::is_nearer(&estimated.estimation, &first.diagnosis) {
        let mut diagnosis = first.diagnosis;
        diagnosis.cost.add(&estimated.estimation.cost);
        return Ok(diagnosis);
    }
    let found = first.found.iter();
    estimated.plant = found.fold(estimated.plant, |plant, effect| {
        plant.without_effect(effect.id())
    });
    let second = look.at(estimated, &first.diagnosis)?;
    Ok(first.or(second))
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
