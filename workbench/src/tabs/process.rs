//! Process of a tab, reached by HTTP/2 over its standard input and output. If it ends unexpectedly, it is started
//! again.

use std::convert::Infallible;
use std::io;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::body::{Body, Bytes, to_bytes};
use axum::extract::Request;
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{Method, StatusCode, Uri};
use axum::response::Response;
use futures_util::StreamExt as _;
use hyper::body::Incoming;
use hyper::client::conn::http2;
use hyper_util::rt::{TokioExecutor, TokioIo};
use tokio::process::{Child, Command};
use tokio::sync::Mutex;

use super::{WINDOW_BYTES, Worker};
use crate::job::Progress;
use crate::names::ProjectId;
use crate::refusal::Refusal;
use crate::session::Opening;

/// Longest time between the closed output of a process and its end.
const ENDING: Duration = Duration::from_secs(10);

/// Tab with its process.
pub(super) struct Tab {
    worker: Worker,
    project: PathBuf,
    opening: Opening,
    was_started: AtomicBool,
    is_closed: AtomicBool,
    process: Mutex<Option<Process>>,
}

struct Process {
    child: Child,
    client: Client,
}

type Client = http2::SendRequest<Body>;

impl Tab {
    pub(super) fn new(worker: Worker, project: PathBuf, opening: Opening) -> Self {
        Self {
            worker,
            project,
            opening,
            was_started: AtomicBool::new(false),
            is_closed: AtomicBool::new(false),
            process: Mutex::default(),
        }
    }

    pub(super) fn id(&self) -> &ProjectId {
        &self.opening.id
    }

    /// Returns the project that it began with a copy of.
    pub(super) fn copy_of(&self) -> Option<&ProjectId> {
        self.opening.copy_of.as_ref()
    }

    /// Starts the process, and returns whether its project has logs.
    pub(super) async fn begin(&self) -> Result<bool, Refusal> {
        let mut place = self.process.lock().await;
        let (process, has_logs) = self.start().await?;
        *place = Some(process);
        Ok(has_logs)
    }

    /// Ends the process in any state.
    pub(super) fn close(self: &Arc<Self>) {
        self.is_closed.store(true, Ordering::Relaxed);
        let tab = Arc::clone(self);
        tokio::spawn(async move { *tab.process.lock().await = None });
    }

    /// Returns the answer of the process to a request.
    pub(super) async fn ask(self: &Arc<Self>, request: Request) -> Result<Response, Refusal> {
        let request = handed_on(request).ok_or_else(|| Refusal::not_found("page"))?;
        let again = again(&request);
        let mut answer = self.client().await?.send_request(request).await;
        if answer.is_err() {
            let reason = self.reason_of_no_answer().await;
            // Another request may have ended the process.
            let again = again.ok_or(reason)?;
            answer = self.client().await?.send_request(again).await;
        }
        let Ok(answer) = answer else {
            return Err(self.reason_of_no_answer().await);
        };
        let (head, body) = answer.into_parts();
        let is_events = head
            .headers
            .get(CONTENT_TYPE)
            .is_some_and(|kind| kind.as_bytes().starts_with(b"text/event-stream"));
        let body = if is_events {
            self.with_end(body)
        } else {
            Body::new(body)
        };
        Ok(Response::from_parts(head, body))
    }

    /// Returns the client of the process; starts a new process if the last one ended.
    async fn client(&self) -> Result<Client, Refusal> {
        let mut place = self.process.lock().await;
        let is_gone = place
            .as_ref()
            .is_none_or(|process| process.client.is_closed());
        if is_gone {
            *place = Some(self.start().await?.0);
        }
        let client = place.as_ref().map(|process| process.client.clone());
        client.ok_or_else(|| self.broken_off())
    }

    /// Starts a process and opens the session in it.
    async fn start(&self) -> Result<(Process, bool), Refusal> {
        if self.is_closed.load(Ordering::Relaxed) {
            return Err(Refusal::not_found("session"));
        }
        let mut process = self.spawn().await.map_err(|error| {
            let message = format!(
                "{}: the process of a tab cannot be started: {error}; close other programs, or start the page again",
                self.worker.program.display()
            );
            Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "E-WEB-PROCESS", message)
        })?;
        let opening = Opening {
            is_again: self.was_started.swap(true, Ordering::Relaxed),
            ..self.opening.clone()
        };
        let json = serde_json::to_vec(&opening).map_err(|_| self.broken_off())?;
        let mut request = Request::new(Body::from(json));
        *request.method_mut() = Method::POST;
        *request.uri_mut() = Uri::from_static("http://tab/sessions");
        let json = "application/json".parse().map_err(|_| self.broken_off())?;
        request.headers_mut().insert(CONTENT_TYPE, json);
        let answer = process.client.send_request(request).await;
        let answer = answer.map_err(|_| self.broken_off())?;
        let answer = to_bytes(Body::new(answer.into_body()), 64).await;
        let has_logs = answer
            .ok()
            .and_then(|body| serde_json::from_slice(&body).ok());
        Ok((process, has_logs.ok_or_else(|| self.broken_off())?))
    }

    async fn spawn(&self) -> io::Result<Process> {
        let mut child = Command::new(&self.worker.program)
            .args(&self.worker.arguments)
            .arg(&self.project)
            .arg(self.worker.memory_bytes.to_string())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            // A backtrace needs memory: where it has run out, the process would wait for itself instead of ending.
            .env("RUST_BACKTRACE", "0")
            .kill_on_drop(true)
            .spawn()?;
        let (Some(output), Some(input)) = (child.stdout.take(), child.stdin.take()) else {
            return Err(io::ErrorKind::BrokenPipe.into());
        };
        let (client, connection) = http2::Builder::new(TokioExecutor::new())
            .initial_stream_window_size(WINDOW_BYTES)
            .initial_connection_window_size(4 * WINDOW_BYTES)
            .handshake(TokioIo::new(tokio::io::join(output, input)))
            .await
            .map_err(io::Error::other)?;
        tokio::spawn(connection);
        Ok(Process { child, client })
    }

    /// Returns the reason of a missing answer: the process ended, or the browser aborted its request.
    async fn reason_of_no_answer(&self) -> Refusal {
        let mut place = self.process.lock().await;
        let has_ended = match place.as_mut() {
            Some(process) => tokio::time::timeout(ENDING, process.child.wait())
                .await
                .is_ok(),
            None => true,
        };
        if has_ended {
            *place = None;
            self.broken_off()
        } else {
            Refusal::broken_off()
        }
    }

    fn broken_off(&self) -> Refusal {
        if self.is_closed.load(Ordering::Relaxed) {
            return Refusal::not_found("session");
        }
        let message = format!(
            "the process of this tab exceeded its memory limit ({} MiB) or crashed; projects and logs are unchanged. Check \
             scale and offset of the columns and the values of the plant, or cut the log",
            self.worker.memory_bytes >> 20
        );
        Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "E-WEB-MEMORY", message)
    }

    /// Returns the events of a job. If its process ends first, the last event states it.
    fn with_end(self: &Arc<Self>, events: Incoming) -> Body {
        let tab = Arc::clone(self);
        let events = Body::new(events).into_data_stream();
        let events = events.scan(false, move |has_ended, event| {
            let event = match event {
                _ if *has_ended => None,
                Ok(event) => Some(event),
                Err(_) => {
                    *has_ended = true;
                    Some(tab.last_event())
                }
            };
            std::future::ready(event.map(Ok::<_, Infallible>))
        });
        Body::from_stream(events)
    }

    fn last_event(&self) -> Bytes {
        let last = if self.is_closed.load(Ordering::Relaxed) {
            Progress::Cancelled
        } else {
            Progress::Failed {
                problems: self.broken_off().problems,
            }
        };
        let json = serde_json::to_string(&last).unwrap_or_default();
        format!("data: {json}\n\n").into()
    }
}

/// Returns the same request again, if it only reads.
fn again(request: &Request) -> Option<Request> {
    if request.method() != Method::GET {
        return None;
    }
    let mut again = Request::new(Body::empty());
    *again.method_mut() = Method::GET;
    again.uri_mut().clone_from(request.uri());
    again.headers_mut().clone_from(request.headers());
    Some(again)
}

/// Returns a request for a process: without the headers between the browser and this server.
fn handed_on(request: Request) -> Option<Request> {
    let (head, body) = request.into_parts();
    let path = head.uri.path_and_query()?.as_str();
    let mut inner = Request::new(body);
    *inner.method_mut() = head.method;
    *inner.uri_mut() = format!("http://tab{path}").parse().ok()?;
    for name in [CONTENT_TYPE, CONTENT_LENGTH] {
        if let Some(value) = head.headers.get(&name) {
            inner.headers_mut().insert(name, value.clone());
        }
    }
    Some(inner)
}
