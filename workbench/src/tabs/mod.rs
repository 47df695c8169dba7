//! Tabs of the browser. Each has its own process under a memory limit, which does all the work of its session; requests
//! are forwarded unchanged. If a process ends, only the computation of its own tab is lost.

mod process;

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use axum::body::HttpBody as _;
use axum::extract::{DefaultBodyLimit, Path, Request, State};
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse as _, Response};
use axum::routing::{any, get, post};
use axum::{Json, Router};
use serde::{Deserialize, Serialize};
use tokio::sync::Semaphore;

use crate::examples::{self, Example};
use crate::job::RETURN;
use crate::lock::lock;
use crate::names::ProjectId;
use crate::pages::JSON_BYTES_MAX;
use crate::refusal::Refusal;
use crate::session::Opening;
use crate::store::{Store, UPLOAD_BYTES_MAX};
use process::Tab;

/// Maximum number of simultaneous tabs; beyond it, the oldest is closed. Its project is kept.
const TABS_MAX: usize = 24;

/// Simultaneous uploads of all tabs together.
const UPLOADS: usize = 2;

/// Bytes of one answer or upload in transit between the processes.
pub(crate) const WINDOW_BYTES: u32 = 1 << 20;

/// Program that does the work of a tab: it calls [`crate::work`] with the arguments that follow these.
#[derive(Debug, Clone)]
pub struct Worker {
    /// Program file.
    pub program: PathBuf,
    /// First arguments of the program.
    pub arguments: Vec<String>,
    /// Memory limit of one tab (bytes).
    pub memory_bytes: u64,
}

impl Worker {
    /// Default memory limit of a tab (bytes): a dozen channels of an hour at 1 kHz, compared.
    pub const MEMORY_BYTES: u64 = 3 << 30;
}

/// All open tabs.
pub(crate) struct Tabs {
    worker: Worker,
    project: PathBuf,
    store: Store,
    uploads: Semaphore,
    open: Mutex<HashMap<ProjectId, Open>>,
}

struct Open {
    /// Order of opening.
    order: u64,
    tab: Arc<Tab>,
    /// When its page was left, unless it is loaded again.
    left: Option<Instant>,
}

/// Returns all routes below `/api`.
pub(crate) fn routes(tabs: Arc<Tabs>) -> Router {
    let length = from_fn_with_state(UPLOAD_BYTES_MAX, refuse_longer);
    let other = from_fn_with_state(JSON_BYTES_MAX, refuse_longer);
    Router::new()
        .route("/examples", get(list_examples))
        .route("/sessions", post(open))
        .route("/sessions/{session}/close", post(close))
        .route("/sessions/{session}/leave", post(leave))
        .route("/sessions/{session}/presence", get(presence))
        .route("/sessions/{session}/{*rest}", any(hand_on))
        .layer(DefaultBodyLimit::max(JSON_BYTES_MAX as usize))
        .layer(other)
        .merge(
            Router::new()
                .route("/sessions/{session}/logs", post(upload))
                .layer(length),
        )
        .with_state(tabs)
}

/// Refuses a request that announces more bytes than its route accepts, before any of them is read.
async fn refuse_longer(State(bytes_max): State<u64>, request: Request, next: Next) -> Response {
    let announced = request.body().size_hint().lower();
    if announced > bytes_max {
        return Refusal::too_large(announced, bytes_max).into_response();
    }
    next.run(request).await
}

async fn list_examples() -> Json<Vec<&'static Example>> {
    Json(examples::all())
}

#[derive(Deserialize)]
struct NewTab {
    /// Project that the tab had open before, if any.
    project: Option<String>,
}

#[derive(Serialize)]
struct Opened {
    session: ProjectId,
    /// Whether it began with a copy of another open project.
    is_copy: bool,
}

async fn open(
    State(tabs): State<Arc<Tabs>>,
    Json(request): Json<NewTab>,
) -> Result<Json<Opened>, Refusal> {
    let wanted = request.project.and_then(|id| ProjectId::try_from(id).ok());
    if let Some(session) = wanted.as_ref().filter(|id| tabs.takes_up(id)) {
        return Ok(Json(Opened {
            session: session.clone(),
            is_copy: false,
        }));
    }
    let tab = tabs.open(wanted.as_ref())?;
    let session = tab.id().clone();
    let has_logs = tab.begin().await.inspect_err(|_| tabs.close(&session))?;
    Ok(Json(Opened {
        is_copy: wanted.as_ref() != Some(&session) && has_logs,
        session,
    }))
}

async fn close(State(tabs): State<Arc<Tabs>>, Path(id): Path<String>) -> Result<(), Refusal> {
    tabs.close(&session_id(id)?);
    Ok(())
}

/// Closes a tab unless its page is loaded again soon.
async fn leave(State(tabs): State<Arc<Tabs>>, Path(id): Path<String>) -> Result<(), Refusal> {
    let id = session_id(id)?;
    if tabs.set_left(&id) {
        tokio::spawn(async move {
            tokio::time::sleep(RETURN).await;
            tabs.close_if_left(&id);
        });
    }
    Ok(())
}

/// Returns whether a tab is open, without a request to its process.
async fn presence(State(tabs): State<Arc<Tabs>>, Path(id): Path<String>) -> Result<(), Refusal> {
    tabs.get(&session_id(id)?).map(drop)
}

fn session_id(id: String) -> Result<ProjectId, Refusal> {
    ProjectId::try_from(id).map_err(|_| Refusal::not_found("session"))
}

/// Forwards a request to the process of its tab.
async fn hand_on(State(tabs): State<Arc<Tabs>>, request: Request) -> Result<Response, Refusal> {
    let id = request.uri().path().split('/').nth(2).unwrap_or_default();
    let tab = tabs.get(&session_id(id.to_owned())?)?;
    tab.ask(request).await
}

async fn upload(State(tabs): State<Arc<Tabs>>, request: Request) -> Result<Response, Refusal> {
    let _place = tabs.uploads.try_acquire().map_err(|_| {
        Refusal::new(
            StatusCode::TOO_MANY_REQUESTS,
            "E-WEB-BUSY",
            "two files are being uploaded; try again when they are complete",
        )
    })?;
    hand_on(State(Arc::clone(&tabs)), request).await
}

impl Tabs {
    pub(crate) fn new(worker: Worker, project: PathBuf, store: Store) -> Self {
        Self {
            worker,
            project,
            store,
            uploads: Semaphore::new(UPLOADS),
            open: Mutex::default(),
        }
    }

    fn get(&self, id: &ProjectId) -> Result<Arc<Tab>, Refusal> {
        let open = lock(&self.open);
        let found = open.get(id).map(|open| Arc::clone(&open.tab));
        found.ok_or_else(|| Refusal::not_found("session"))
    }

    /// Opens a tab. A `wanted` project is opened under its own id if no other tab has it open, otherwise as a copy with
    /// its findings. Without `wanted`, the tab begins with a copy of the project that was changed last.
    fn open(&self, wanted: Option<&ProjectId>) -> Result<Arc<Tab>, Refusal> {
        // One lock from the check to the answer: of two simultaneous tabs, one gets a copy.
        let mut open = lock(&self.open);
        let live = wanted.and_then(|id| open.get(id));
        let stored = wanted.filter(|id| self.store.has(id));
        let opening = match (live, stored, wanted) {
            (Some(live), _, Some(id)) => Opening {
                id: ProjectId::random()?,
                copy_of: stored.cloned().or_else(|| live.tab.copy_of().cloned()),
                findings_of: Some(id.clone()),
                is_again: false,
            },
            (None, Some(id), _) => Opening {
                id: id.clone(),
                copy_of: None,
                findings_of: None,
                is_again: false,
            },
            _ => Opening {
                id: ProjectId::random()?,
                copy_of: self.store.newest(),
                findings_of: None,
                is_again: false,
            },
        };
        if open.len() >= TABS_MAX {
            let oldest = open.iter().min_by_key(|(_, open)| open.order);
            if let Some(oldest) = oldest.map(|(id, _)| id.clone())
                && let Some(oldest) = open.remove(&oldest)
            {
                oldest.tab.close();
            }
        }
        let order = open.values().map(|open| open.order + 1).max().unwrap_or(0);
        let id = opening.id.clone();
        let tab = Arc::new(Tab::new(self.worker.clone(), self.project.clone(), opening));
        open.insert(
            id,
            Open {
                order,
                tab: Arc::clone(&tab),
                left: None,
            },
        );
        Ok(tab)
    }

    /// Takes up a tab whose page was left: it goes on with its process and its job. Returns whether there is one.
    fn takes_up(&self, id: &ProjectId) -> bool {
        let mut open = lock(&self.open);
        open.get_mut(id)
            .is_some_and(|open| open.left.take().is_some())
    }

    /// Notes that the page of a tab was left; returns whether the tab is open.
    fn set_left(&self, id: &ProjectId) -> bool {
        let mut open = lock(&self.open);
        let left = open.get_mut(id).map(|open| &mut open.left);
        left.map(|left| *left = Some(Instant::now())).is_some()
    }

    fn close_if_left(&self, id: &ProjectId) {
        let left = lock(&self.open).get(id).and_then(|open| open.left);
        if left.is_some_and(|since| since.elapsed() >= RETURN) {
            self.close(id);
        }
    }

    /// Ends the work of a tab and closes it; its project and its findings are kept.
    fn close(&self, id: &ProjectId) {
        if let Some(open) = lock(&self.open).remove(id) {
            open.tab.close();
        }
    }
}
