//! Estimation of the ordinary parameters of a plant from its logs: the best model with the given physics, before a missing effect is
//! reported.
//!
//! `stages` contains the fit, in `rounds` with the assignment of the commands; `determination` rates how well the logs determine each
//! parameter; `result` is the answer.

mod determination;
#[cfg(test)]
mod effect_tests;
mod lag;
mod profile;
mod result;
mod rounds;
mod stages;
#[cfg(test)]
mod tests;
mod weak_directions;

use std::time::Instant;

use plant_sim::PlantParameters;
use recording::Recording;

use super::error::DiagnoseError;
use super::evidence::Evidence;
use super::evidence::logged_supply::with_logged_supply;
use super::evidence::unknowns::Unknowns;
use super::fit::split::Split;
use super::fit::trial::{Bench, Trial};
use super::knowledge::state_first_file;
use super::refine::with_provenance;
use super::result::StepKind;
use super::search::assemble;
use super::search::{Watch, report, report_error};
pub(super) use determination::DETERMINED;
use determination::estimated_parameters;
pub(super) use lag::lag_of_logs;
use result::Left;
pub use result::{
    Determination, ESTIMATION_SCHEMA, EstimatedParameter, EstimatedPlant, Estimation,
};
use stages::{Fitted, Intervals};
pub(super) use weak_directions::measure_weak_directions;

/// Estimates the ordinary parameters of `plant`, and the parameters of the effects that it has, from `logs`. Validation uses data that was
/// not fitted: `check`, or without it, held-out blocks of the logs.
///
/// Values without a statement in the plant file may be as wrong as those of a first plant file.
///
/// # Errors
/// [`DiagnoseError`]: a log cannot be used, or `watch` stopped the estimation.
pub fn estimate(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<EstimatedPlant, DiagnoseError> {
    estimate_with(plant, logs, check, Intervals::Always, watch)
}

/// Estimates as [`estimate`] does, for a search for effects. The intervals of a model that leaves more than the noise are then too narrow
/// in directions that the logs leave undetermined. The search does not use them.
pub(super) fn for_search(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<EstimatedPlant, DiagnoseError> {
    estimate_with(plant, logs, check, Intervals::OfAdequateModel, watch)
}

fn estimate_with(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    intervals: Intervals,
    watch: Watch,
) -> Result<EstimatedPlant, DiagnoseError> {
    let begin = Instant::now();
    if logs.is_empty() {
        return Err(DiagnoseError::NoLog);
    }
    report(watch, "clocks of the loggers", 0.0)?;
    let lag_of = lag_of_logs(plant, logs, check, watch)?;
    let mut plant = with_logged_supply(&plant.with_lag_of(lag_of), logs.iter().chain(check));
    state_first_file(&mut plant);
    let plant = &plant;
    let mut split = Split::as_given(plant, logs, check)?;
    let given = bench(plant, &split).as_given();
    let given = given.ok_or_else(|| split.not_simulated())?;
    report_error(watch, "plant as given", 0.0, Some(&given.fitted))?;
    let Fitted {
        unknowns,
        fit,
        sharp,
        is_converged,
    } = stages::fit(plant, &mut split, intervals, watch)?;
    let bench = bench(plant, &split);
    let trial = bench.judge(plant.effects.clone(), unknowns, fit);
    let trial = trial.ok_or_else(|| split.not_simulated())?;
    let sharp = Trial {
        fit: sharp,
        ..trial.clone()
    };
    let (parameters, correlations) = estimated_parameters(&split.fitting, &sharp);
    let left = Left::of(&trial, !check.is_empty());
    let steps = [
        (StepKind::PlantAsGiven, &given),
        (StepKind::ParametersRefitted, &trial),
    ];
    let steps = steps.map(|(kind, trial)| assemble::step(&bench, trial, &given, kind));
    let estimation = Estimation {
        schema: ESTIMATION_SCHEMA.to_owned(),
        logs: split.fitting.sources(),
        check: split.check_sources(),
        not_compared: split.not_compared(),
        defects: split.defects(),
        held_out: split.held_out().to_owned(),
        sentence: result::sentence(left, is_converged, &parameters),
        is_adequate: left == Left::Noise,
        explains_fitted_logs: matches!(left, Left::Noise | Left::MoreOnCheck),
        is_converged,
        steps: steps.into(),
        parameters,
        correlations,
        clocks: split.clocks(),
        starts: split.starts(),
        cost: split.cost(begin),
    };
    let mut refined = with_provenance(&trial, &estimation.logs);
    result::state_knowledge(&mut refined, plant, &estimation);
    Ok(EstimatedPlant {
        plant: refined,
        estimation,
    })
}

fn bench<'a>(plant: &'a PlantParameters, split: &'a Split) -> Bench<'a> {
    Bench {
        plant,
        library: &[],
        fitting: &split.fitting,
        checking: &split.checking,
    }
}

fn unknowns_of(plant: &PlantParameters, evidence: &Evidence) -> Unknowns {
    Unknowns::new(plant, &plant.effects, &evidence.logs)
}
