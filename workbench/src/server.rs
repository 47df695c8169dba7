//! Binds, prints nothing, serves until it is stopped.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use axum::Router;
use axum::middleware::from_fn_with_state;
use axum::routing::get;
use tokio::net::TcpListener;
use tokio::sync::Notify;
use tokio::task::JoinSet;

use crate::assets;
use crate::connections::{Places, accept};
use crate::guard::{Gate, guard};
use crate::loopback::Loopback;
use crate::refusal::Refusal;
use crate::store::{FolderError, Store};
use crate::tabs::{self, Tabs, Worker};
use crate::token::Secrets;

/// The usual port, so that a bookmark of a view holds over restarts.
const USUAL_PORT: u16 = 7474;

/// What to serve, and where.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder that keeps logs and projects; made if it is not there.
    pub project: PathBuf,
    /// The port on the loopback interface; none takes 7474, or a free one if that is taken.
    pub port: Option<u16>,
    /// What does the work of each tab.
    pub worker: Worker,
}

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The project folder.
    #[error(transparent)]
    Project(#[from] FolderError),
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
    tabs: Arc<Tabs>,
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
        let (store, unreadable) = Store::open(&options.project)?;
        Ok(Self {
            unreadable,
            gate: Arc::new(Gate {
                port: loopback.port,
                secrets: Secrets::new()?,
            }),
            loopback,
            tabs: Arc::new(Tabs::new(
                options.worker.clone(),
                options.project.clone(),
                store,
            )),
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
            .nest("/api", tabs::routes(self.tabs))
            .fallback(async || Refusal::not_found("page"))
            .layer(from_fn_with_state(self.gate, guard));
        let places = Places::new();
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
