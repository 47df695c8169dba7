//! Estimates the ordinary parameters of a plant from its logs: the model as good as its physics allows, before anything is said
//! to be missing.
//!
//! The stages follow what each can see. A first plant file may be 30 % off, so the first stage forgives large errors (pseudo-Huber
//! loss) and only brings the model near. Then the clocks of the loggers are set again, by a model that is nearly right. The last
//! stage is least squares, unless it leaves more than noise: then physics is missing, whose errors least squares would spread over
//! the parameters, and the forgiving estimate stays.

mod determination;
mod result;
#[cfg(test)]
mod tests;

use std::time::Instant;

use plant_sim::PlantParameters;
use recording::Recording;

use super::assemble;
use super::error::DiagnoseError;
use super::errors::Errors;
use super::evidence::Evidence;
use super::fit::{Descent, Fit, Fitter};
use super::log::Run;
use super::logger_time::{Delay, best_delay_s, find_clock, set_clocks};
use super::nuisance::Trust;
use super::refine::with_provenance;
use super::search::{Watch, report};
use super::split::Split;
use super::trial::{Bench, Trial};
use super::unknowns::{Unknown, Unknowns};
use determination::estimated_parameters;
pub use result::{
    Determination, ESTIMATION_SCHEMA, EstimatedParameter, EstimatedPlant, Estimation,
    EstimationStep, EstimationStepKind,
};

/// Residuals beyond this many noise floors count in proportion in the first stages.
const OUTLIER: f64 = 3.0;
/// Steps of the differences in the last stage, over the usual ones: a parameter may be known to a hundredth of its tolerance.
const FINE: f64 = 0.1;
/// A decrease below this share of the cost ends the last stage: what hardly shows in the cost is wanted as well.
const CONVERGED_SHARE: f64 = 1e-6;
/// The forgiving stage is run this often; the commands are assigned to the samples of the ECU anew after each.
const ROUNDS: usize = 2;

/// Estimates the ordinary parameters of `plant`, and the parameters of the effects that it has, from `logs`. Validation uses data
/// that was not fitted: `check`, or without it, blocks of the logs.
///
/// Values that the plant file gives without a statement may be as far off as those of a first plant file.
///
/// # Errors
/// [`DiagnoseError`]: a log cannot be used, or `watch` stopped it.
pub fn estimate(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    watch: Watch,
) -> Result<EstimatedPlant, DiagnoseError> {
    let begin = Instant::now();
    if logs.is_empty() {
        return Err(DiagnoseError::NoLog);
    }
    report(watch, "clocks of the loggers", 0.0)?;
    let mut split = Split::as_given(plant, logs, check)?;
    let given = judged_as_given(plant, &split).ok_or_else(|| split.not_simulated())?;
    let (unknowns, fit) = fit(plant, &mut split, watch)?;
    let trial = bench(plant, &split).judge(plant.effects.clone(), unknowns, fit);
    let trial = trial.ok_or_else(|| split.not_simulated())?;
    report(watch, "intervals", 0.0)?;
    let bench = bench(plant, &split);
    let mut sharp = trial.clone();
    sharp.sharpen(&bench).ok_or_else(|| split.not_simulated())?;
    let parameters = estimated_parameters(&split.fitting, &sharp);
    let steps = [
        (EstimationStepKind::PlantAsGiven, &given),
        (EstimationStepKind::ParametersEstimated, &trial),
    ];
    let steps = steps.map(|(kind, trial)| EstimationStep {
        kind,
        errors: assemble::step(&bench, trial, &given, None),
    });
    let estimation = Estimation {
        schema: ESTIMATION_SCHEMA.to_owned(),
        logs: split.fitting.sources(),
        check: split.check_sources(),
        not_compared: split.not_compared(),
        defects: split.defects(),
        held_out: split.held_out().to_owned(),
        sentence: result::sentence(!trial.is_material(), &parameters),
        is_adequate: !trial.is_material(),
        steps: steps.into(),
        parameters,
        clocks: split.clocks(),
        cost: split.cost(begin),
    };
    let mut plant = with_provenance(&trial, &estimation.logs);
    result::state_knowledge(&mut plant, &estimation);
    Ok(EstimatedPlant { plant, estimation })
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
    Unknowns::new(
        plant,
        &plant.effects,
        Trust::FirstFile,
        evidence.has_pressure(),
    )
    .with_clocks(&evidence.logs)
}

/// The plant as given, without any fit but of the loggers' clocks.
fn judged_as_given(plant: &PlantParameters, split: &Split) -> Option<Trial> {
    let unknowns = unknowns_of(plant, &split.fitting);
    let fit = Fitter::new(&split.fitting, &unknowns).at(unknowns.start())?;
    bench(plant, split).judge(plant.effects.clone(), unknowns, fit)
}

/// A fit with the coordinates that it is in.
type Fitted = (Unknowns, Fit);

fn fit(plant: &PlantParameters, split: &mut Split, watch: Watch) -> Result<Fitted, DiagnoseError> {
    let mut unknowns = unknowns_of(plant, &split.fitting);
    let mut z = unknowns.start();
    begin_at_delay(&unknowns, &mut z, best_delay_s(plant, &split.fitting));
    for round in 0..ROUNDS {
        let done = round as f64 / ROUNDS as f64;
        report(watch, "estimating, large errors forgiven", done)?;
        let mut fitter = Fitter::new(&split.fitting, &unknowns);
        fitter.outlier_scale = Some(OUTLIER);
        let start = fitter.at(z).ok_or_else(|| split.not_simulated())?;
        let fit = fitter.descend(start, Descent::Whole);
        let fit = fit.ok_or_else(|| split.not_simulated())?;
        (unknowns, z) = assigned_anew(plant, split, &unknowns, &fit.z);
    }
    report(watch, "estimating, least squares", 0.0)?;
    let mut fitter = Fitter::new(&split.fitting, &unknowns);
    fitter.step_scale = FINE;
    fitter.converged_share = CONVERGED_SHARE;
    let forgiving = fitter.at(z).ok_or_else(|| split.not_simulated())?;
    let least = fitter.descend(forgiving.clone(), Descent::Whole);
    let least = least.ok_or_else(|| split.not_simulated())?;
    set_clocks(&unknowns.plant(&least.z), &mut split.checking);
    let errors = Errors::new(&split.fitting, &least.residuals, Run::Predicted);
    let kept = if errors.is_material() {
        forgiving
    } else {
        least
    };
    Ok((unknowns, kept))
}

/// Puts the delay of the commands where the logs show it best: a step of a fit sees no further than a pulse.
fn begin_at_delay(unknowns: &Unknowns, z: &mut [f64], delay_s: f64) {
    for (unknown, z) in unknowns.list().iter().zip(z) {
        if let Unknown::Nuisance(nuisance) = unknown
            && nuisance.spec.name() == "ecu.command_delay_s"
        {
            let (least, most) = unknown.bounds();
            *z = unknown.coordinate_of(delay_s).clamp(least, most);
        }
    }
}

/// Takes the fitted clocks for those of the loggers, looks for those that are not known yet, and assigns the commands by all of
/// them. The coordinates of the clocks begin there.
fn assigned_anew(
    plant: &PlantParameters,
    split: &mut Split,
    fitted: &Unknowns,
    z: &[f64],
) -> (Unknowns, Vec<f64>) {
    let there = fitted.plant(z);
    let mut clocks = split.fitting.clocks();
    fitted.clocks(z, &mut clocks);
    split.fitting.set_clocks(&clocks, &there);
    for log in split
        .fitting
        .logs
        .iter_mut()
        .filter(|log| log.clock.is_none())
    {
        find_clock(&there, log, Delay::AsGiven);
    }
    let unknowns = unknowns_of(plant, &split.fitting);
    let mut next = unknowns.start();
    for ((to, unknown), from) in next.iter_mut().zip(unknowns.list()).zip(z) {
        if !matches!(unknown, Unknown::Clock(_)) {
            *to = *from;
        }
    }
    (unknowns, next)
}
