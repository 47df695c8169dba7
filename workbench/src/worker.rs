//! Process of one tab: the routes of all pages, over standard input and output, under a memory limit.

use std::path::Path;
use std::sync::Arc;

use hyper::server::conn::http2;
use hyper_util::rt::{TokioExecutor, TokioIo};
use hyper_util::service::TowerToHyperService;

use crate::pages;
use crate::refusal::Refusal;
use crate::server::ServeError;
use crate::session::Sessions;
use crate::store::Store;
use crate::tabs::WINDOW_BYTES;

/// Longest headers of a request: the address contains the state of a view.
const HEADERS_BYTES_MAX: u32 = 1 << 20;

/// Does the work of one tab until its server ends. It uses standard input and output, so the program may print nothing.
///
/// An allocation beyond `memory_bytes` ends this process, and not the server.
///
/// # Errors
/// Returns a [`ServeError`] if the folder cannot be used or the operating system provides no threads.
pub fn work(project: &Path, memory_bytes: u64) -> Result<(), ServeError> {
    limit_memory(memory_bytes)?;
    let store = Store::join(project)?;
    let sessions = Arc::new(Sessions::new(Arc::new(store)));
    let router = pages::routes(sessions).fallback(async || Refusal::not_found("page"));
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()?;
    runtime.block_on(async {
        let stream = tokio::io::join(tokio::io::stdin(), tokio::io::stdout());
        // The connection ends with the server, for any reason.
        let _ = http2::Builder::new(TokioExecutor::new())
            .initial_stream_window_size(WINDOW_BYTES)
            .initial_connection_window_size(4 * WINDOW_BYTES)
            .max_header_list_size(HEADERS_BYTES_MAX)
            .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
            .await;
    });
    // Computations for a closed page are not awaited.
    runtime.shutdown_background();
    Ok(())
}

/// Limited resource: allocated data, not address space, of which threads reserve much.
#[cfg(target_os = "linux")]
const MEMORY: rustix::process::Resource = rustix::process::Resource::Data;
#[cfg(all(unix, not(target_os = "linux")))]
const MEMORY: rustix::process::Resource = rustix::process::Resource::As;

#[cfg(unix)]
fn limit_memory(bytes: u64) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let limit = |bytes: u64| Rlimit {
        current: Some(bytes),
        maximum: Some(bytes),
    };
    setrlimit(MEMORY, limit(bytes))?;
    // A core dump would not be useful.
    setrlimit(Resource::Core, limit(0))?;
    Ok(())
}

/// Sets no limit. If memory is short, the operating system ends the largest process, which is not the server.
#[cfg(not(unix))]
fn limit_memory(_bytes: u64) -> std::io::Result<()> {
    Ok(())
}
