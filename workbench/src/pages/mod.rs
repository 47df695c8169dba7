//! Pages: each has one file of routes here and one module in `web/pages/`.

pub(crate) mod compare;
pub(crate) mod control;
pub(crate) mod diagnose;
mod estimate;
mod experiment_limits;
mod logs;
mod plant_steps;
mod points;
pub(crate) mod refine;
mod report;

use std::convert::Infallible;
use std::sync::Arc;

use axum::extract::{DefaultBodyLimit, Path, State};
use axum::http::StatusCode;
use axum::response::Sse;
use axum::response::sse::Event;
use axum::routing::{get, post};
use axum::{Json, Router};
use futures_util::Stream;
use serde::Serialize;

use crate::job::{Job, Span};
use crate::names::ProjectId;
use crate::refusal::Refusal;
use crate::session::{Opening, Session, Sessions};

/// Longest request other than an upload (bytes): a plant, a mapping, a reference profile.
pub(crate) const JSON_BYTES_MAX: u64 = 2 << 20;

/// State that the routes of a page share.
pub(crate) type Shared = State<Arc<Sessions>>;

/// Returns all routes of a session.
pub(crate) fn routes(sessions: Arc<Sessions>) -> Router {
    Router::new()
        .route("/sessions", post(open))
        .route("/sessions/{session}/jobs/{job}", get(events).delete(stop))
        .merge(logs::routes())
        .merge(compare::routes())
        .merge(estimate::routes())
        .merge(diagnose::routes())
        .merge(refine::routes())
        .merge(control::routes())
        .merge(report::routes())
        .layer(DefaultBodyLimit::max(JSON_BYTES_MAX as usize))
        .with_state(sessions)
}

/// Returns the session in the path.
pub(crate) fn session(sessions: &Sessions, id: String) -> Result<Arc<Session>, Refusal> {
    let id = ProjectId::try_from(id).map_err(|_| Refusal::not_found("session"))?;
    sessions.get(&id)
}

/// Runs file access on a thread that may block.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|_| {
        Err(Refusal::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "E-WEB-INTERNAL",
            "internal error of the program, not of the data; please report it with the log",
        ))
    })
}

/// Number of a job, by which its events are requested.
#[derive(Serialize)]
pub(crate) struct Begun {
    job: u64,
}

/// Begins a job of a session, with progress for its page; a running job of the same span ends.
pub(crate) fn begin_job(
    session: &Arc<Session>,
    span: Span,
    work: impl FnOnce(&Session, &Job) -> Result<(), Refusal> + Send + 'static,
) -> Json<Begun> {
    let worker = Arc::clone(session);
    let store = Arc::clone(&session.store);
    let job = Job::start(
        span,
        move || store.take_place(),
        move |job| work(&worker, job),
    );
    let number = job.number;
    session.begin(span, job);
    Json(Begun { job: number })
}

/// Opens the session of this process, and returns whether it has logs.
async fn open(State(sessions): Shared, Json(opening): Json<Opening>) -> Json<bool> {
    let session = sessions.open(opening);
    Json(!session.project().logs.is_empty())
}

/// Ends a job at its next step; one that has ended or given way to another stays as it is.
async fn stop(
    State(sessions): Shared,
    Path((id, job)): Path<(String, u64)>,
) -> Result<(), Refusal> {
    if let Some(job) = session(&sessions, id)?.job(job) {
        job.cancel();
    }
    Ok(())
}

async fn events(
    State(sessions): Shared,
    Path((id, job)): Path<(String, u64)>,
) -> Result<Sse<impl Stream<Item = Result<Event, Infallible>>>, Refusal> {
    let session = session(&sessions, id)?;
    let job = session.job(job).ok_or_else(|| Refusal::not_found("job"))?;
    Ok(job.events())
}
