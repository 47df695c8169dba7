//! Estimation of the ordinary parameters of the current plant, as a step of its history.

use axum::Json;
use axum::extract::{Path, State};
use model_lab::diagnosis::{EstimatedPlant, Estimation, estimate as estimate_parameters};

use crate::history::{Interval, Step, StepEffect};
use crate::job::Span;
use crate::pages::plant_steps::{Fitting, add_fitted, fitting, note_errors};
use crate::pages::{Begun, Shared, begin_job};
use crate::refusal::Refusal;

/// Begins an estimation from the current plant, with the effects that are on.
pub(super) async fn estimate(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(request): Json<Fitting>,
) -> Result<Json<Begun>, Refusal> {
    let (session, history) = fitting(&sessions, id, &request)?;
    Ok(begin_job(&session, Span::Tab, move |session, job| {
        let now = history.now();
        let logs = session.recordings(&request.chosen.logs)?;
        let check = session.recordings(&request.chosen.check)?;
        note_errors(session, request.log)?;
        let plant = now.plant.parameters()?;
        let estimated = estimate_parameters(&plant, &logs, &check, &|seen| job.watch(seen))?;
        add_fitted(
            session,
            job,
            now,
            estimated_step(now, estimated, history.first())?,
        )?;
        note_errors(session, request.log)
    }))
}

fn estimated_step(before: &Step, estimated: EstimatedPlant, first: &Step) -> Result<Step, Refusal> {
    let EstimatedPlant { plant, estimation } = estimated;
    let effects = before.effects.iter().map(|effect| {
        let setting = plant.effect(&effect.effect).filter(|_| effect.is_on);
        setting.map_or_else(
            || effect.clone(),
            |setting| with_intervals(StepEffect::of(setting, &[]), &estimation),
        )
    });
    let logs = estimation.logs.join(", ");
    let done = format!("estimated the ordinary parameters from {logs}");
    let step = Step::to(&plant, done, effects.collect(), first)?;
    Ok(Step {
        estimation: Some(estimation),
        ..step
    })
}

fn with_intervals(mut effect: StepEffect, estimation: &Estimation) -> StepEffect {
    for parameter in &mut effect.parameters {
        let name = format!("effects.{}.{}", effect.effect, parameter.key);
        let estimated = estimation.parameters.iter().find(|one| one.name == name);
        parameter.fitted = estimated.map(|one| Interval {
            value: one.after,
            low: one.low,
            high: one.high,
        });
    }
    effect
}
