//! Page "Compare": measured and modelled signals, and their differences.

mod band;
mod cursor;
mod difference;
mod export;
mod fold;
mod residual;
mod scatter;
mod selection;
mod states;
mod statistics;
mod traces;

use std::sync::Arc;

use axum::extract::{Path, Query, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::{get, post};
use axum::{Json, Router};
use model_lab::{Comparison, compare_watched};
use serde::Deserialize;

use super::{Begun, Shared, begin_job, session};
use crate::align;
use crate::job::{Job, Span};
use crate::pages::blocking;
use crate::pages::points::Range;
use crate::refusal::Refusal;
use crate::results::Compared;
use crate::session::{Session, Sessions};

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/logs/{log}/compare", post(begin))
        .route("/sessions/{session}/logs/{log}/comparison", get(result))
        .route("/sessions/{session}/logs/{log}/traces", get(show_traces))
        .route("/sessions/{session}/logs/{log}/values", get(show_values))
        .route("/sessions/{session}/logs/{log}/scatter", get(show_scatter))
        .route("/sessions/{session}/logs/{log}/fold", get(show_fold))
        .route(
            "/sessions/{session}/logs/{log}/distribution",
            get(show_distribution),
        )
        .route(
            "/sessions/{session}/logs/{log}/spectrum",
            get(show_spectrum),
        )
        .route(
            "/sessions/{session}/logs/{log}/difference",
            get(show_difference),
        )
        .route(
            "/sessions/{session}/logs/{log}/alignment",
            get(show_alignment),
        )
        .route("/sessions/{session}/logs/{log}/csv", get(export_csv))
        .route("/sessions/{session}/logs/{log}/mf4", get(export_mf4))
}

/// Begins the comparison of a log with the plant; a running comparison or run of the same tab ends.
async fn begin(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
) -> Result<Json<Begun>, Refusal> {
    let session = session(&sessions, id)?;
    session.project().log(log)?;
    Ok(begin_job(&session, Span::Page, move |session, job| {
        work(session, log, job)
    }))
}

fn work(session: &Session, number: u32, job: &Job) -> Result<(), Refusal> {
    let project = session.project();
    let parameters = project.plant.parameters()?;
    let log = session.log(number)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let options = project.strictness.options_for(&log.recording);
    let goes_on = |share| job.goes_on(share);
    let comparison = compare_watched(&parameters, &log.recording, &options, &goes_on)?;
    let compared = Compared::new(comparison, parameters);
    if job.goes_on(1.0) {
        session.keep_comparison(number, compared);
    }
    Ok(())
}

fn compared(session: &Session, log: u32) -> Result<Arc<Compared>, Refusal> {
    let compared = session.comparison(log);
    compared.ok_or_else(|| {
        Refusal::too_early("the log is not compared with this plant yet; compare it first")
    })
}

/// Returns the comparison: the same JSON that `retarder compare --json` writes.
async fn result(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
) -> Result<Json<Comparison>, Refusal> {
    let session = session(&sessions, id)?;
    Ok(Json(compared(&session, log)?.comparison.clone()))
}

async fn show_traces(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(view): Query<traces::View>,
) -> Result<Json<traces::Traces>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || traces::traces(&session, log, &view).map(Json)).await
}

async fn show_values(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(at): Query<cursor::Instant>,
) -> Result<Json<cursor::Values>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || cursor::values(&session, log, at.time_s).map(Json)).await
}

async fn show_scatter(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(axes): Query<scatter::Axes>,
) -> Result<Json<scatter::Scatter>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || scatter::scatter(&session, log, &axes).map(Json)).await
}

async fn show_fold(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(fold): Query<fold::Folding>,
) -> Result<Json<fold::Fold>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || fold::fold(&session, log, &fold).map(Json)).await
}

async fn show_distribution(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(request): Query<statistics::Request>,
) -> Result<Json<statistics::Distribution>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || statistics::distribution(&session, log, &request).map(Json)).await
}

async fn show_spectrum(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(request): Query<statistics::Request>,
) -> Result<Json<statistics::Spectral>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || statistics::spectrum(&session, log, &request).map(Json)).await
}

async fn show_difference(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(request): Query<difference::Request>,
) -> Result<Json<difference::Differences>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || difference::differences(&session, log, &request).map(Json)).await
}

#[derive(Deserialize)]
struct Alignment {
    /// Log that stays in place.
    with: u32,
    signal: String,
}

async fn show_alignment(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(request): Query<Alignment>,
) -> Result<Json<align::Alignment>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let [moved, fixed] = [session.log(log)?, session.log(request.with)?];
        let moved = moved.as_ref().as_ref().map_err(Clone::clone)?;
        let fixed = fixed.as_ref().as_ref().map_err(Clone::clone)?;
        align::align(&fixed.recording, &moved.recording, &request.signal).map(Json)
    })
    .await
}

/// Exports the range of a view: measured, modelled and residual of every signal.
async fn export_csv(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(range): Query<Range>,
) -> Result<impl IntoResponse, Refusal> {
    let session = session(&sessions, id)?;
    let csv = blocking(move || export::csv(&session, log, range)).await?;
    let headers = [
        (CONTENT_TYPE, "text/csv; charset=utf-8"),
        // The page names the file by log and plant.
        (CONTENT_DISPOSITION, "attachment"),
    ];
    Ok((headers, csv))
}

/// Exports the same data as MF4.
async fn export_mf4(
    State(sessions): Shared,
    Path((id, log)): Path<(String, u32)>,
    Query(range): Query<Range>,
) -> Result<impl IntoResponse, Refusal> {
    let session = session(&sessions, id)?;
    let mf4 = blocking(move || export::mf4(&session, log, range)).await?;
    let headers = [
        (CONTENT_TYPE, "application/octet-stream"),
        // The page names the file by log and plant.
        (CONTENT_DISPOSITION, "attachment"),
    ];
    Ok((headers, mf4))
}
