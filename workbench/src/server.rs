//! Binds, prints nothing, serves until it is stopped.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::middleware::from_fn_with_state;
use axum::routing::get;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpListener;
use tokio::sync::{Notify, Semaphore};
use tokio::task::JoinSet;

use crate::assets;
use crate::guard::{Gate, guard};
use crate::loopback::Loopback;
use crate::pages;
use crate::refusal::Refusal;
use crate::session::Sessions;
use crate::store::Store;
use crate::token::Secrets;

/// The usual port, so that a bookmark of a view holds over restarts.
const USUAL_PORT: u16 = 7474;
/// Connections at one time; a browser has six.
const CONNECTIONS_MAX: usize = 512;
/// Longest time for the headers of a request.
const HEADERS_DEADLINE: Duration = Duration::from_secs(15);

/// What to serve, and where.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder that keeps logs and projects; made if it is not there.
    pub project: PathBuf,
    /// The port on the loopback interface; none takes 7474, or a free one if that is taken.
    pub port: Option<u16>,
}

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The project folder.
    #[error("{}: {error}; choose a folder that you may write, with --project", folder.display())]
    Project {
        /// The folder.
        folder: PathBuf,
        /// What the operating system says.
        error: io::Error,
    },
    /// The port.
    #[error(
        "port {port} of the loopback interface: {error}; choose another with --port, or leave the option out"
    )]
    Port {
        /// The port.
        port: u16,
        /// What the operating system says.
        error: io::Error,
    },
    /// The operating system has no randomness to give.
    #[error("no token could be drawn: {0}")]
    Token(#[from] getrandom::Error),
    /// The runtime or the socket.
    #[error("the server cannot run: {0}")]
    Run(#[from] io::Error),
}

/// A server that has its port and its project folder, and waits to run.
pub struct Server {
    loopback: Loopback,
    gate: Arc<Gate>,
    sessions: Arc<Sessions>,
    stop: Arc<Notify>,
    unreadable: Vec<String>,
}

/// Stops a server from another thread.
#[derive(Clone)]
pub struct Stopper(Arc<Notify>);

impl Stopper {
    /// Ends [`Server::run`].
    pub fn stop(&self) {
        self.0.notify_one();
    }
}

impl Server {
    /// Takes the port on the loopback interface, and on no other, and opens the project folder.
    ///
    /// # Errors
    /// [`ServeError`]: the port is taken, or the folder cannot be used.
    pub fn bind(options: &Options) -> Result<Self, ServeError> {
        let loopback = match options.port {
            Some(0) => Loopback::on_free_port()?,
            Some(port) => Loopback::on(port).map_err(|error| ServeError::Port { port, error })?,
            None => Loopback::on(USUAL_PORT).or_else(|_| Loopback::on_free_port())?,
        };
        let (store, unreadable) =
            Store::open(&options.project).map_err(|error| ServeError::Project {
                folder: options.project.clone(),
                error,
            })?;
        Ok(Self {
            unreadable,
            gate: Arc::new(Gate {
                port: loopback.port,
                secrets: Secrets::new()?,
            }),
            loopback,
            sessions: Arc::new(Sessions::new(Arc::new(store))),
            stop: Arc::default(),
        })
    }

    /// The address to open, with the token of this start. It is good for one browser.
    pub fn address(&self) -> String {
        let Gate { port, secrets } = &*self.gate;
        format!("http://127.0.0.1:{port}/?token={}", secrets.token())
    }

    /// What is wrong with projects of the folder that cannot be read, for people.
    pub fn unreadable_projects(&self) -> &[String] {
        &self.unreadable
    }

    /// What stops [`Self::run`].
    pub fn stopper(&self) -> Stopper {
        Stopper(Arc::clone(&self.stop))
    }

    /// Serves until it is stopped.
    ///
    /// # Errors
    /// The operating system gives no threads or takes the socket away.
    pub fn run(self) -> Result<(), ServeError> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .build()?;
        let served = runtime.block_on(self.serve());
        // Whatever is computed for pages that are gone is not waited for.
        runtime.shutdown_background();
        served
    }

    async fn serve(self) -> Result<(), ServeError> {
        let router = Router::new()
            .route("/", get(assets::index))
            .route("/assets/{*path}", get(assets::asset))
            .nest("/api", pages::routes(self.sessions))
            .fallback(async || Refusal::not_found("page"))
            .layer(from_fn_with_state(self.gate, guard));
        let places = Arc::new(Semaphore::new(CONNECTIONS_MAX));
        let mut accepting = JoinSet::new();
        for socket in self.loopback.sockets {
            socket.set_nonblocking(true)?;
            let listener = TcpListener::from_std(socket)?;
            accepting.spawn(accept(listener, router.clone(), Arc::clone(&places)));
        }
        // What still accepts ends with its set.
        self.stop.notified().await;
        Ok(())
    }
}

/// Takes connections of one socket, as long as there is a place for another.
async fn accept(listener: TcpListener, router: Router, places: Arc<Semaphore>) {
    while let Ok(place) = Arc::clone(&places).acquire_owned().await {
        let Ok((stream, _)) = listener.accept().await else {
            // One connection that failed, or no file handles for a moment.
            tokio::time::sleep(Duration::from_millis(20)).await;
            continue;
        };
        let router = router.clone();
        tokio::spawn(async move {
            let _place = place;
            let _ = stream.set_nodelay(true);
            serve_connection(stream, router).await;
        });
    }
}

/// Answers the requests of one connection. One that breaks off concerns its page alone.
async fn serve_connection(stream: impl AsyncRead + AsyncWrite + Unpin + Send, router: Router) {
    let _ = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEADERS_DEADLINE)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .await;
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
    use tokio::time::Instant;

    use super::*;

    /// Rule 6: whoever does not finish the headers is let go, and no earlier than the deadline says. The clock is the test's.
    #[test]
    fn headers_that_do_not_end_are_waited_for_until_the_deadline() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .start_paused(true)
            .build()
            .unwrap();
        runtime.block_on(async {
            let (mut client, server) = tokio::io::duplex(1024);
            let serving = tokio::spawn(serve_connection(server, Router::new()));
            let begin = Instant::now();
            client
                .write_all(b"GET / HTTP/1.1\r\nHost: x")
                .await
                .unwrap();
            let mut answer = Vec::new();
            client.read_to_end(&mut answer).await.unwrap();
            serving.await.unwrap();
            let waited = begin.elapsed();
            assert!(
                (HEADERS_DEADLINE..2 * HEADERS_DEADLINE).contains(&waited),
                "{waited:?}"
            );
        });
    }
}
