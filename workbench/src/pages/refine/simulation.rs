//! Simulation of the plant on a log, repeated whenever a slider moves.

use std::time::Instant;

use model_lab::free_run;
use plant_sim::PlantParameters;
use plant_sim::replay::ROW_SIGNALS;
use serde::{Deserialize, Serialize};

use super::change::moved;
use crate::history::{History, Step, StepError};
use crate::lock::lock;
use crate::pages::plant_steps::history;
use crate::pages::points::{Drawn, Points, Range};
use crate::plant_file::PlantFile;
use crate::refusal::Refusal;
use crate::session::{LoadedLog, Session};

/// Largest number of stored errors; beyond it, all are dropped.
const REMEMBERED_MAX: usize = 256;

/// Simulation and its visible range.
#[derive(Debug, Deserialize)]
pub(super) struct View {
    log: u32,
    from_s: Option<f64>,
    to_s: Option<f64>,
    /// Points of each series.
    points: usize,
    /// Parameter that a slider moves; all three fields or none.
    effect: Option<String>,
    key: Option<String>,
    value: Option<f64>,
}

#[derive(Serialize)]
pub(super) struct Simulation {
    /// Simulated time (s).
    log_s: f64,
    /// Computing time of the simulation of the log (ms).
    simulation_ms: f64,
    signals: Vec<SignalRun>,
    /// Error steps, from the plant as opened to the last effect that is on.
    error_steps: Vec<Rung>,
}

/// Modelled series of a signal that is also measured.
#[derive(Serialize)]
struct SignalRun {
    name: String,
    unit: &'static str,
    error: StepError,
    model: Points,
}

/// Row of the error steps.
#[derive(Serialize)]
struct Rung {
    /// Id of the effect that this row adds; `None` for the plant as opened.
    added: Option<String>,
    title: String,
    errors: Vec<StepError>,
}

pub(super) fn simulate(session: &Session, view: &View) -> Result<Simulation, Refusal> {
    let history = history(session)?;
    let step = match (&view.effect, &view.key, view.value) {
        (Some(effect), Some(key), Some(value)) => moved(history.now(), effect, key, value)?,
        _ => history.now().clone(),
    };
    let log = session.log(view.log)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let plant = step.plant.parameters()?;
    let conditions = log.conditions(&history.base().plant)?;
    let begin = Instant::now();
    let run = free_run(&plant, &log.recording, &conditions)?;
    let simulation_ms = begin.elapsed().as_secs_f64() * 1e3;
    let errors: Vec<StepError> = run.errors.iter().map(StepError::from).collect();
    let Some((_, base)) = run.model.time_bases().next() else {
        return Err(Refusal::not_found("time base"));
    };
    let drawn = Drawn {
        range: Range {
            from_s: view.from_s,
            to_s: view.to_s,
        },
        points: view.points,
    };
    let signals = errors.iter().filter_map(|error| {
        let signal = run.model.signal(&error.signal)?;
        let model = Points::of(base, signal.values_or_nan(), drawn);
        Some(model.map(|model| SignalRun {
            name: error.signal.clone(),
            unit: unit_of(&error.signal),
            error: error.clone(),
            model,
        }))
    });
    Ok(Simulation {
        log_s: base.end_s() - base.start_s(),
        simulation_ms,
        signals: signals.collect::<Result<_, _>>()?,
        error_steps: error_steps((session, view.log, log), &history, &step, &errors)?,
    })
}

fn unit_of(name: &str) -> &'static str {
    let mut signals = ROW_SIGNALS.iter();
    let signal = signals.find(|(signal, _)| *signal == name);
    signal.map_or("", |(_, unit)| unit.symbol())
}

/// Returns the errors of the plant as opened, then with the ordinary parameters of `step`, then with one effect after
/// the other, so that no effect is credited with the fit of the ordinary parameters. The errors of `step` are known.
fn error_steps(
    (session, number, log): (&Session, u32, &LoadedLog),
    history: &History,
    step: &Step,
    errors: &[StepError],
) -> Result<Vec<Rung>, Refusal> {
    let first = history.first();
    let on: Vec<_> = step.effects.iter().filter(|effect| effect.is_on).collect();
    let is_old = |id: &str| first.effect(id).is_some_and(|effect| effect.is_on);
    let of_plant = |count: usize| {
        if count == on.len() {
            return Ok(errors.to_vec());
        }
        let plant = step.plant_with_first(count)?;
        let on = (session, number, log, &history.base().plant);
        errors_of(on, &plant.to_toml(), || Ok(plant.clone()))
    };
    let mut rungs = vec![Rung {
        added: None,
        title: format!("plant as opened: {}", first.plant.name),
        errors: errors_of(
            (session, number, log, &first.plant),
            &first.plant.toml,
            || first.plant.parameters(),
        )?,
    }];
    let old = on.iter().filter(|effect| is_old(&effect.effect)).count();
    let opened = first.plant.parameters()?;
    let now = step.plant_with_first(old)?;
    let mut changed = opened
        .specs()
        .filter(|spec| spec.value(&opened) != spec.value(&now))
        .peekable();
    if changed.peek().is_some() {
        let title = if changed.any(|spec| spec.effect_id().is_none()) {
            "ordinary parameters refitted"
        } else {
            "effects of the opened plant changed"
        };
        rungs.push(Rung {
            added: None,
            title: title.to_owned(),
            errors: of_plant(old)?,
        });
    }
    for (index, effect) in on.iter().enumerate() {
        if is_old(&effect.effect) {
            continue;
        }
        rungs.push(Rung {
            added: Some(effect.effect.clone()),
            title: format!(
                "+ {} ({})",
                effect.effect.replace(['_', '.'], " "),
                effect.variant
            ),
            errors: of_plant(index + 1)?,
        });
    }
    Ok(rungs)
}

/// Returns the errors of a plant on a log under its conditions by `base`, simulated if they are not known.
fn errors_of(
    (session, number, log, base): (&Session, u32, &LoadedLog, &PlantFile),
    toml: &str,
    plant: impl FnOnce() -> Result<PlantParameters, Refusal>,
) -> Result<Vec<StepError>, Refusal> {
    let key = (number, toml.to_owned());
    if let Some(errors) = lock(&session.errors).get(&key) {
        return Ok(errors.clone());
    }
    let plant = plant()?;
    let run = free_run(&plant, &log.recording, &log.conditions(base)?)?;
    let errors: Vec<StepError> = run.errors.iter().map(StepError::from).collect();
    let mut known = lock(&session.errors);
    if known.len() >= REMEMBERED_MAX {
        known.clear();
    }
    known.insert(key, errors.clone());
    Ok(errors)
}

/// Sets the errors of the current step on a log; a plant that cannot be simulated there has none. Another log, or other
/// columns of the same one, require a new simulation.
pub(in crate::pages) fn measure(
    session: &Session,
    number: u32,
    history: &mut History,
) -> Result<(), Refusal> {
    let name = session.project().log(number)?.name.clone();
    let plant = history.now().plant.clone();
    let log = session.log(number)?;
    let Ok(log) = log.as_ref() else { return Ok(()) };
    let on = (session, number, log, &history.base().plant);
    if let Ok(errors) = errors_of(on, &plant.toml, || plant.parameters()) {
        history.measure(&name, errors);
    }
    Ok(())
}
