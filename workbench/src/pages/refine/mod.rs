//! Page "Refine": effects are added, adjusted, fitted, evaluated and undone.

mod change;
mod estimate;
mod experiment;
mod refitted;
mod simulation;

use std::sync::Arc;

use axum::extract::{Path, Query, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::{get, post};
use axum::{Json, Router};
use model_lab::diagnosis::{Estimation, Refined, Refinement, refine};
use serde::{Deserialize, Serialize};

use super::{Begun, Shared, begin_job, blocking, session};
use crate::history::{History, Step, StepEffect, StepError};
use crate::job::{Job, Span};
use crate::plant_sketch::SketchView;
use crate::project::{PlantFile, Project};
use crate::refusal::Refusal;
use crate::results::Chosen;
use crate::session::{Session, Sessions};
use change::{Change, REFINED};
use refitted::{RefittedParameter, refitted};

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/refine", get(show))
        .route("/sessions/{session}/refine/change", post(change_plant))
        .route("/sessions/{session}/refine/simulation", get(simulate))
        .route("/sessions/{session}/refine/fit", post(fit))
        .route(
            "/sessions/{session}/refine/estimate",
            post(estimate::estimate),
        )
        .route(
            "/sessions/{session}/refine/experiment",
            get(experiment::planned).post(experiment::plan),
        )
        .route(
            "/sessions/{session}/refine/experiment/csv",
            get(experiment::export_csv),
        )
        .route("/sessions/{session}/refine/plant", get(plant_file))
}

/// Returns the history of the session's plant; it begins again if another page changed the plant.
fn history(session: &Session) -> Result<History, Refusal> {
    let project = session.project();
    if project.history.is_of(&project.plant) {
        return Ok(project.history);
    }
    History::begin(&project.plant)
}

fn of_plant(project: &mut Project) -> Result<&mut History, Refusal> {
    if !project.history.is_of(&project.plant) {
        project.history = History::begin(&project.plant)?;
    }
    Ok(&mut project.history)
}

/// Stores the errors of the current step, and of the one before it, on a log.
fn note_errors(session: &Session, log: u32) -> Result<(), Refusal> {
    let mut measured = history(session)?;
    let at = measured.at();
    // A change may add two steps.
    if let Some(before) = at.checked_sub(1) {
        measured.go_to(before)?;
        simulation::measure(session, log, &mut measured)?;
        measured.go_to(at)?;
    }
    simulation::measure(session, log, &mut measured)?;
    session.change(|project| {
        // Another request may have changed the plant in the meantime.
        if measured.is_of(&project.plant) {
            project.history = measured;
        }
        Ok(())
    })
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
    /// The last estimation up to that step.
    estimation: Option<Estimation>,
}

#[derive(Serialize)]
struct StepView {
    done: String,
    log: String,
    errors: Vec<StepError>,
}

impl RefineView {
    fn of(history: History) -> Result<Self, Refusal> {
        let refitted = refitted(&history)?;
        let until_now = &history.steps()[..=history.at()];
        let steps = history.steps().iter().map(|step| StepView {
            done: step.done.clone(),
            log: step.log.clone(),
            errors: step.errors.clone(),
        });
        let now = history.now();
        Ok(Self {
            refitted,
            opened: history.first().plant.name.clone(),
            plant: now.plant.name.clone(),
            sketch: SketchView::of(&now.plant.parameters()?),
            effects: now.effects.clone(),
            steps: steps.collect(),
            at: history.at(),
            fit: until_now.iter().rev().find_map(|step| step.fit.clone()),
            estimation: history.base().estimation.clone(),
        })
    }
}

#[derive(Deserialize)]
struct OnLog {
    /// Log whose errors are stored with the step.
    log: u32,
}

async fn show(
    State(sessions): Shared,
    Path(id): Path<String>,
    Query(on): Query<OnLog>,
) -> Result<Json<RefineView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let mut history = history(&session)?;
        simulation::measure(&session, on.log, &mut history)?;
        RefineView::of(history).map(Json)
    })
    .await
}

#[derive(Deserialize)]
struct Changing {
    log: u32,
    change: Change,
}

async fn change_plant(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(request): Json<Changing>,
) -> Result<Json<RefineView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        session.project().log(request.log)?;
        let diagnosed = session.findings().diagnosed;
        note_errors(&session, request.log)?;
        session.change(|project| {
            let history = of_plant(project)?;
            request.change.apply(history, diagnosed.as_deref())?;
            project.plant = project.history.now().plant.clone();
            Ok(())
        })?;
        session.forget_comparisons();
        note_errors(&session, request.log)?;
        RefineView::of(history(&session)?).map(Json)
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

#[derive(Deserialize)]
struct Fitting {
    log: u32,
    #[serde(flatten)]
    chosen: Chosen,
}

/// Returns the session `id` with its history, if it has the logs that `request` requests.
fn fitting(
    sessions: &Sessions,
    id: String,
    request: &Fitting,
) -> Result<(Arc<Session>, History), Refusal> {
    let session = session(sessions, id)?;
    request.chosen.check(&session.project())?;
    session.project().log(request.log)?;
    let history = history(&session)?;
    Ok((session, history))
}

/// Begins a fit of all effects that are on, together with the parameters that differ between rigs, from the plant as
/// opened or as last estimated.
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
        let step = fitted_step(now, refined)?;
        add_fitted(session, job, now, step)?;
        note_errors(session, request.log)
    }))
}

/// Adds `step`, which was computed from the step `now`.
fn add_fitted(session: &Session, job: &Job, now: &Step, step: Step) -> Result<(), Refusal> {
    if job.is_cancelled() {
        return Ok(());
    }
    session.change(|project| {
        if project.plant != now.plant {
            return Err(Refusal::too_early(
                "the plant was changed while it was fitted; fit again",
            ));
        }
        project.plant = step.plant.clone();
        project.history.push(step);
        Ok(())
    })?;
    session.clear_comparisons();
    Ok(())
}

/// Returns the ids of effects that the plant had in the step `base` and does not have any more.
fn now_gone<'a>(effects: &'a [StepEffect], base: &'a Step) -> impl Iterator<Item = &'a str> {
    base.effects
        .iter()
        .map(|effect| &effect.effect[..])
        .filter(|id| !effects.iter().any(|effect| effect.effect == *id))
}

fn fitted_step(before: &Step, refined: Refined) -> Result<Step, Refusal> {
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
    Ok(Step {
        done: format!(
            "fitted {} and the ordinary parameters to {}",
            names.join(" and "),
            refinement.logs.join(", ")
        ),
        effects: effects.collect(),
        plant: PlantFile {
            name: REFINED.to_owned(),
            toml: plant.to_toml(),
        },
        log: String::new(),
        errors: Vec::new(),
        fit: Some(refinement),
        estimation: None,
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
