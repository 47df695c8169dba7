//! Page "Refine": effects are added, adjusted, fitted, evaluated and undone.

mod change;
mod refitted;
mod simulation;

use std::sync::Arc;

use axum::extract::{Path, Query, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::{get, post};
use axum::{Json, Router};
use model_lab::diagnosis::{Refined, Refinement, refine};
use serde::{Deserialize, Serialize};

use super::plant_steps::{
    Fitting, OnLog, StepView, add_fitted, change_plant, fitting, history, note_errors,
};
use super::{Begun, Shared, begin_job, blocking, session};
use crate::history::{History, Step, StepEffect};
use crate::job::Span;
use crate::plant_sketch::SketchView;
use crate::refusal::Refusal;
use crate::session::Sessions;
use change::Change;
use refitted::{RefittedParameter, refitted};
pub(super) use simulation::measure;

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/refine", get(show))
        .route("/sessions/{session}/refine/change", post(change))
        .route("/sessions/{session}/refine/simulation", get(simulate))
        .route("/sessions/{session}/refine/fit", post(fit))
        .route("/sessions/{session}/refine/plant", get(plant_file))
}

#[derive(Serialize)]
struct RefineView {
    /// Name of the plant as opened.
    opened: String,
    plant: String,
    /// Sketch of the plant with the effects that are on.
    sketch: Option<SketchView>,
    effects: Vec<StepEffect>,
    refitted: Vec<RefittedParameter>,
    steps: Vec<StepView>,
    /// Index of the current step.
    at: usize,
    /// The last fit up to that step.
    fit: Option<Refinement>,
}

impl RefineView {
    fn of(history: History) -> Result<Self, Refusal> {
        let refitted = refitted(&history)?;
        let until_now = &history.steps()[..=history.at()];
        let now = history.now();
        Ok(Self {
            refitted,
            opened: history.first().plant.name.clone(),
            plant: now.plant.name.clone(),
            sketch: SketchView::of(&now.plant.parameters()?),
            effects: now.effects.clone(),
            steps: StepView::all_of(&history),
            at: history.at(),
            fit: until_now.iter().rev().find_map(|step| step.fit.clone()),
        })
    }
}

async fn show(
    State(sessions): Shared,
    Path(id): Path<String>,
    Query(on): Query<OnLog>,
) -> Result<Json<RefineView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let mut history = history(&session)?;
        measure(&session, on.log, &mut history)?;
        RefineView::of(history).map(Json)
    })
    .await
}

#[derive(Deserialize)]
struct Changing {
    log: u32,
    change: Change,
}

async fn change(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(request): Json<Changing>,
) -> Result<Json<RefineView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let diagnosed = session.findings().diagnosed;
        let apply = |history: &mut History| request.change.apply(history, diagnosed.as_deref());
        let history = change_plant(&session, request.log, apply)?;
        RefineView::of(history).map(Json)
    })
    .await
}

async fn simulate(
    State(sessions): Shared,
    Path(id): Path<String>,
    Query(view): Query<simulation::View>,
) -> Result<Json<simulation::Simulation>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || simulation::simulate(&session, &view).map(Json)).await
}

/// Begins a fit of all effects that are on, together with the parameters that differ between rigs, from the plant as
/// opened, or as last stated or estimated.
async fn fit(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(request): Json<Fitting>,
) -> Result<Json<Begun>, Refusal> {
    let (session, history) = fitting(&sessions, id, &request)?;
    if !history.now().effects.iter().any(|effect| effect.is_on) {
        return Err(Refusal::too_early(
            "there is no effect to fit; add one or switch one on",
        ));
    }
    Ok(begin_job(&session, Span::Tab, move |session, job| {
        let now = history.now();
        let (on, off): (Vec<_>, Vec<_>) = now.effects.iter().partition(|effect| effect.is_on);
        let base = history.base();
        let opened = now_gone(&now.effects, base)
            .chain(off.iter().map(|effect| &effect.effect[..]))
            .fold(base.plant.parameters()?, |plant, id| {
                plant.without_effect(id)
            });
        let add: Vec<_> = on
            .iter()
            .map(|effect| (effect.effect.clone(), Some(effect.variant.clone())))
            .collect();
        let logs = session.recordings(&request.chosen.logs)?;
        let check = session.recordings(&request.chosen.check)?;
        note_errors(session, request.log)?;
        let refined = refine(&opened, &logs, &check, &add, &|seen| job.watch(seen))?;
        let step = fitted_step(now, refined, history.first())?;
        add_fitted(session, job, now, step)?;
        note_errors(session, request.log)
    }))
}

/// Returns the ids of effects that the plant had in the step `base` and does not have any more.
fn now_gone<'a>(effects: &'a [StepEffect], base: &'a Step) -> impl Iterator<Item = &'a str> {
    base.effects
        .iter()
        .map(|effect| &effect.effect[..])
        .filter(|id| !effects.iter().any(|effect| effect.effect == *id))
}

fn fitted_step(before: &Step, refined: Refined, first: &Step) -> Result<Step, Refusal> {
    let Refined { plant, refinement } = refined;
    let effects = before.effects.iter().map(|effect| {
        let setting = plant.effect(&effect.effect).filter(|_| effect.is_on);
        let mut fitted = refinement.effects.iter();
        let found = fitted.find(|one| one.effect == effect.effect);
        match (setting, found) {
            (Some(setting), Some(found)) => StepEffect::of(setting, &found.parameters),
            _ => effect.clone(),
        }
    });
    let names = before.effects.iter().filter(|effect| effect.is_on);
    let names: Vec<_> = names
        .map(|effect| effect.effect.replace(['_', '.'], " "))
        .collect();
    let done = format!(
        "fitted {} and the ordinary parameters to {}",
        names.join(" and "),
        refinement.logs.join(", ")
    );
    let step = Step::to(&plant, done, effects.collect(), first)?;
    Ok(Step {
        fit: Some(refinement),
        ..step
    })
}

/// Returns the current plant: the file that `retarder refine --out` writes.
async fn plant_file(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Refusal> {
    let session = session(&sessions, id)?;
    let plant = session.project().plant;
    let headers = [
        (CONTENT_TYPE, "text/plain; charset=utf-8"),
        (CONTENT_DISPOSITION, "attachment; filename=\"refined.toml\""),
    ];
    Ok((headers, plant.toml))
}
