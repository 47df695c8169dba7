//! The pages: each is one file of routes here and one module in `web/pages/`.

pub(crate) mod compare;
pub(crate) mod control;
pub(crate) mod diagnose;
mod logs;
pub(crate) mod refine;
mod report;

use std::convert::Infallible;
use std::sync::Arc;

use axum::body::HttpBody as _;
use axum::extract::{DefaultBodyLimit, Path, Request, State};
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn_with_state};
use axum::response::sse::Event;
use axum::response::{IntoResponse as _, Response, Sse};
use axum::routing::{get, post};
use axum::{Json, Router};
use futures_util::Stream;
use serde::{Deserialize, Serialize};

use crate::job::Job;
use crate::names::ProjectId;
use crate::refusal::Refusal;
use crate::session::{Session, Sessions};
use crate::store::UPLOAD_BYTES_MAX;

/// Longest request that is no upload (bytes): a plant, a mapping, a reference profile.
const JSON_BYTES_MAX: u64 = 2 << 20;

/// What the routes of a page share.
pub(crate) type Shared = State<Arc<Sessions>>;

/// All routes below `/api`.
pub(crate) fn routes(sessions: Arc<Sessions>) -> Router {
    Router::new()
        .route("/sessions", post(open))
        .route("/sessions/{session}/close", post(close))
        .route("/sessions/{session}/jobs/{job}", get(events))
        .merge(logs::routes())
        .merge(compare::routes())
        .merge(diagnose::routes())
        .merge(refine::routes())
        .merge(control::routes())
        .merge(report::routes())
        .layer(DefaultBodyLimit::max(JSON_BYTES_MAX as usize))
        .layer(from_fn_with_state(JSON_BYTES_MAX, refuse_longer))
        .merge(logs::uploads().layer(from_fn_with_state(UPLOAD_BYTES_MAX, refuse_longer)))
        .with_state(sessions)
}

/// Refuses a request that announces more bytes than its route takes, before any of them is read.
async fn refuse_longer(State(bytes_max): State<u64>, request: Request, next: Next) -> Response {
    let announced = request.body().size_hint().lower();
    if announced > bytes_max {
        return Refusal::too_large(announced, bytes_max).into_response();
    }
    next.run(request).await
}

/// The session that the path names.
pub(crate) fn session(sessions: &Sessions, id: String) -> Result<Arc<Session>, Refusal> {
    let id = ProjectId::try_from(id).map_err(|_| Refusal::not_found("session"))?;
    sessions.get(&id)
}

/// Files are read on threads that may wait.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|_| {
        Err(Refusal::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "E-WEB-INTERNAL",
            "this is a mistake of the program, not of the data; please report it with the log",
        ))
    })
}

/// The number of a job, by which its events are asked for.
#[derive(Serialize)]
pub(crate) struct Begun {
    job: u64,
}

/// Begins work of a session, watched and ended by its page; what is under way in the same tab ends.
pub(crate) fn begin_job(
    sessions: &Sessions,
    session: &Arc<Session>,
    work: impl FnOnce(&Session, &Job) -> Result<(), Refusal> + Send + 'static,
) -> Json<Begun> {
    let worker = Arc::clone(session);
    let job = Job::start(Arc::clone(&sessions.workers), move |job| work(&worker, job));
    let number = job.number;
    session.begin(job);
    Json(Begun { job: number })
}

#[derive(Deserialize)]
struct Open {
    /// Project that the tab had open before, if any.
    project: Option<String>,
}

#[derive(Serialize)]
struct Opened {
    session: ProjectId,
    /// Whether it began with what another project has open.
    is_copy: bool,
}

async fn open(State(sessions): Shared, Json(wish): Json<Open>) -> Result<Json<Opened>, Refusal> {
    let wanted = wish.project.and_then(|id| ProjectId::try_from(id).ok());
    let session = sessions.open(wanted)?;
    Ok(Json(Opened {
        session: session.id.clone(),
        is_copy: session.is_copy,
    }))
}

async fn close(State(sessions): Shared, Path(id): Path<String>) -> Result<(), Refusal> {
    let id = ProjectId::try_from(id).map_err(|_| Refusal::not_found("session"))?;
    sessions.close(&id);
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
