//! Connections: few places for clients without a valid cookie, and a deadline for clients that do not send or read.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpListener;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::AbortHandle;
use tokio_io_timeout::TimeoutStream;

use crate::lock::lock;

/// Maximum number of simultaneous connections that sent the cookie of this start; a browser uses six.
const PROVED_MAX: usize = 448;
/// Maximum number of simultaneous connections that have not sent the cookie yet. The oldest is closed for a new one.
const UNPROVED_MAX: usize = 64;
/// Deadline for the headers of a request.
const HEADERS_DEADLINE: Duration = Duration::from_secs(15);
/// Longest time for which a client may read nothing of an answer.
const WRITE_DEADLINE: Duration = Duration::from_secs(30);

/// Places of all connections.
pub(crate) struct Places {
    numbers: AtomicU64,
    /// Connections without a valid cookie, oldest first.
    unproved: Mutex<VecDeque<(u64, AbortHandle)>>,
    proved: Arc<Semaphore>,
}

/// Place of one connection.
#[derive(Clone)]
pub(crate) struct Place(Arc<Held>);

struct Held {
    places: Arc<Places>,
    number: u64,
    proved: OnceLock<OwnedSemaphorePermit>,
}

impl Places {
    pub(crate) fn new() -> Arc<Self> {
        Arc::new(Self {
            numbers: AtomicU64::new(0),
            unproved: Mutex::default(),
            proved: Arc::new(Semaphore::new(PROVED_MAX)),
        })
    }

    /// Runs `serve` in a place of its own. Without a free place, the oldest unproved connection is closed.
    fn take<F: Future<Output = ()> + Send + 'static>(
        self: &Arc<Self>,
        serve: impl FnOnce(Place) -> F,
    ) {
        let number = self.numbers.fetch_add(1, Ordering::Relaxed);
        let place = Place(Arc::new(Held {
            places: Arc::clone(self),
            number,
            proved: OnceLock::new(),
        }));
        let surplus = {
            // Locked until the connection is listed, since it leaves the list when it ends.
            let mut unproved = lock(&self.unproved);
            let serving = tokio::spawn(serve(place));
            unproved.push_back((number, serving.abort_handle()));
            if unproved.len() > UNPROVED_MAX {
                unproved.pop_front()
            } else {
                None
            }
        };
        if let Some((_, oldest)) = surplus {
            oldest.abort();
        }
    }

    fn leave(&self, number: u64) {
        lock(&self.unproved).retain(|(other, _)| *other != number);
    }
}

impl Place {
    /// Marks the connection as proved by the cookie: from now on it is not closed for another one.
    pub(crate) fn prove(&self) {
        let Self(held) = self;
        if held.proved.get().is_none()
            && let Ok(permit) = Arc::clone(&held.places.proved).try_acquire_owned()
            && held.proved.set(permit).is_ok()
        {
            held.places.leave(held.number);
        }
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.places.leave(self.number);
    }
}

/// Accepts the connections to one socket.
pub(crate) async fn accept(listener: TcpListener, router: Router, places: Arc<Places>) {
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // One connection failed, or there are temporarily no file handles.
            tokio::time::sleep(Duration::from_millis(20)).await;
            continue;
        };
        let router = router.clone();
        places.take(|place| async move {
            let _ = stream.set_nodelay(true);
            serve_connection(stream, router, place).await;
        });
    }
}

/// Answers the requests of one connection. A broken connection affects its own page only.
async fn serve_connection(
    stream: impl AsyncRead + AsyncWrite + Send,
    router: Router,
    place: Place,
) {
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(WRITE_DEADLINE));
    let router = router.layer(Extension(place));
    let _ = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEADERS_DEADLINE)
        .serve_connection(
            TokioIo::new(Box::pin(stream)),
            TowerToHyperService::new(router),
        )
        .await;
}

#[cfg(test)]
mod tests {
    use axum::routing::get;
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _, DuplexStream};
    use tokio::time::{Instant, timeout};

    use super::*;

    /// Runs `test` with a clock that advances only when all tasks wait.
    fn with_paused_clock(test: impl Future<Output = ()>) {
        tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .start_paused(true)
            .build()
            .unwrap()
            .block_on(test);
    }

    /// Connects a client to a server whose one page proves the session.
    fn connect(places: &Arc<Places>) -> DuplexStream {
        let page = get(async |Extension(place): Extension<Place>| {
            place.prove();
            "x".repeat(4096)
        });
        let router = Router::new().route("/", page);
        let (client, server) = tokio::io::duplex(1024);
        places.take(|place| serve_connection(server, router, place));
        client
    }

    /// Returns how long the server keeps a connection, and the length of its answer.
    async fn kept_for(client: &mut DuplexStream) -> (Duration, usize) {
        let begin = Instant::now();
        let mut answer = Vec::new();
        let ended = timeout(Duration::from_secs(3600), client.read_to_end(&mut answer)).await;
        ended.expect("the server never ends it").unwrap();
        (begin.elapsed(), answer.len())
    }

    /// Rule 6: a client that does not finish the headers is disconnected at the deadline and not earlier. The clock is
    /// the test's.
    #[test]
    fn headers_that_do_not_end_are_waited_for_until_the_deadline() {
        with_paused_clock(async {
            let mut client = connect(&Places::new());
            client
                .write_all(b"GET / HTTP/1.1\r\nHost: x")
                .await
                .unwrap();
            let (waited, _) = kept_for(&mut client).await;
            assert!(
                (HEADERS_DEADLINE..2 * HEADERS_DEADLINE).contains(&waited),
                "{waited:?}"
            );
        });
    }

    /// Defect seen: a client that sent a request and never read kept its connection open forever.
    #[test]
    fn an_answer_that_nobody_reads_is_waited_for_until_the_deadline() {
        with_paused_clock(async {
            let places = Places::new();
            let mut client = connect(&places);
            client
                .write_all(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
                .await
                .unwrap();
            let ended = timeout(2 * WRITE_DEADLINE, async {
                while places.proved.available_permits() == PROVED_MAX {
                    tokio::time::sleep(Duration::from_secs(1)).await;
                }
                let begin = Instant::now();
                while places.proved.available_permits() < PROVED_MAX {
                    tokio::time::sleep(Duration::from_secs(1)).await;
                }
                begin.elapsed()
            });
            let waited = ended.await.expect("it was never let go");
            assert!(
                waited >= WRITE_DEADLINE - Duration::from_secs(2),
                "{waited:?}"
            );
        });
    }

    /// Defect seen: 520 clients without a cookie blocked all other clients.
    #[test]
    fn whoever_proves_nothing_makes_room_for_those_who_come() {
        with_paused_clock(async {
            let places = Places::new();
            let mut proved = connect(&places);
            proved
                .write_all(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
                .await
                .unwrap();
            let mut byte = [0];
            proved.read_exact(&mut byte).await.unwrap();
            let mut silent: Vec<_> = (0..520).map(|_| connect(&places)).collect();
            let (first, rest) = silent.split_first_mut().unwrap();
            assert_eq!(kept_for(first).await, (Duration::ZERO, 0));
            let last = rest.last_mut().unwrap();
            assert_eq!(kept_for(last).await, (HEADERS_DEADLINE, 0));
            // The connection that proved its session is still open, and a new one is served.
            let (_, length) = kept_for(&mut proved).await;
            assert!(length > 4096, "{length}");
            let mut late = connect(&places);
            late.write_all(b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
                .await
                .unwrap();
            assert!(kept_for(&mut late).await.1 > 4096);
        });
    }
}
