//! Server: binds, serves until it is stopped, and prints nothing.

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

/// Default port, so that a bookmark of a view stays valid after a restart.
const USUAL_PORT: u16 = 7474;

/// Options of the server.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder for logs and projects; created if it is missing.
    pub project: PathBuf,
    /// Port on the loopback interface; `None` takes 7474, or a free port if that is in use.
    pub port: Option<u16>,
    /// Program that does the work of each tab.
    pub worker: Worker,
}

/// Reason why the server cannot run.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// Project folder.
    #[error(transparent)]
    Project(#[from] FolderError),
    /// Port.
    #[error(
        "port {port} of the loopback interface: {error}; choose another with --port, or leave the option out"
    )]
    Port {
        /// Port.
        port: u16,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The operating system has no random numbers.
    #[error("no token could be drawn: {0}")]
    Token(#[from] getrandom::Error),
    /// Runtime or socket.
    #[error("the server cannot run: {0}")]
    Run(#[from] io::Error),
}

/// Server with its port and its project folder, ready to run.
pub struct Server {
    loopback: Loopback,
    gate: Arc<Gate>,
    tabs: Arc<Tabs>,
    stop: Arc<Notify>,
    unreadable: Vec<String>,
}

/// Handle that stops a server from another thread.
#[derive(Clone)]
pub struct Stopper(Arc<Notify>);

impl Stopper {
    /// Ends [`Server::run`].
    pub fn stop(&self) {
        self.0.notify_one();
    }
}

impl Server {
    /// Binds the port on the loopback interface only, and opens the project folder.
    ///
    /// # Errors
    /// Returns a [`ServeError`] if the port is in use or the folder cannot be used.
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

    /// Returns the address to open, with the token of this start. It works in one browser.
    pub fn address(&self) -> String {
        let Gate { port, secrets } = &*self.gate;
        format!("http://127.0.0.1:{port}/?token={}", secrets.token())
    }

    /// Returns the problems of unreadable projects in the folder.
    pub fn unreadable_projects(&self) -> &[String] {
        &self.unreadable
    }

    /// Returns the handle that stops [`Self::run`].
    pub fn stopper(&self) -> Stopper {
        Stopper(Arc::clone(&self.stop))
    }

    /// Serves until it is stopped.
    ///
    /// # Errors
    /// Returns an error if the operating system refuses threads or closes the socket.
    pub fn run(self) -> Result<(), ServeError> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .build()?;
        let served = runtime.block_on(self.serve());
        // Computations for closed pages are not awaited.
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
        // Tasks that still accept connections end with their set.
        self.stop.notified().await;
        Ok(())
    }
}
