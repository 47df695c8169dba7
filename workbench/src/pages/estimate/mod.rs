//! Page "Estimate": how well each value is known, and the estimation of the ordinary parameters.

mod change;
mod experiment;
mod parameters;
mod run;

use std::sync::Arc;

use axum::extract::{Path, Query, State};
use axum::routing::{get, post};
use axum::{Json, Router};
use model_lab::diagnosis::Estimation;
use serde::{Deserialize, Serialize};

use super::plant_steps::{OnLog, StepView, change_plant, history};
use super::refine::measure;
use super::{Shared, blocking, session};
use crate::history::History;
use crate::refusal::Refusal;
use crate::session::Sessions;
use change::Change;
use parameters::ParameterView;

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/estimate", get(show))
        .route("/sessions/{session}/estimate/change", post(change))
        .route("/sessions/{session}/estimate/run", post(run::estimate))
        .route(
            "/sessions/{session}/estimate/experiment",
            get(experiment::planned).post(experiment::plan),
        )
        .route(
            "/sessions/{session}/estimate/experiment/csv",
            get(experiment::export_csv),
        )
}

#[derive(Serialize)]
struct EstimateView {
    plant: String,
    /// Parameters that an estimation may move, in the order of the plant file, and those that are fixed.
    parameters: Vec<ParameterView>,
    /// Tables of the plant file that the page edits as text.
    tables: String,
    steps: Vec<StepView>,
    /// Index of the current step.
    at: usize,
    /// The last estimation up to that step.
    estimation: Option<Estimation>,
}

impl EstimateView {
    fn of(history: &History) -> Result<Self, Refusal> {
        let now = history.now();
        Ok(Self {
            plant: now.plant.name.clone(),
            parameters: ParameterView::all_of(history)?,
            tables: now.plant.parameters()?.edited_tables(),
            steps: StepView::all_of(history),
            at: history.at(),
            estimation: history.estimation().cloned(),
        })
    }
}

async fn show(
    State(sessions): Shared,
    Path(id): Path<String>,
    Query(on): Query<OnLog>,
) -> Result<Json<EstimateView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let mut history = history(&session)?;
        measure(&session, on.log, &mut history)?;
        EstimateView::of(&history).map(Json)
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
) -> Result<Json<EstimateView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let apply = |history: &mut History| request.change.apply(history);
        let history = change_plant(&session, request.log, apply)?;
        EstimateView::of(&history).map(Json)
    })
    .await
}
