//! Jobs that take longer than a request, with progress events. A session runs one of each [`Span`] at a time. A job ends
//! with the client that listens to its events; one of a tab waits for the page that is loaded again.

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use axum::response::Sse;
use axum::response::sse::{Event, KeepAlive};
use futures_util::{Stream, stream};
use model_lab::diagnosis;
use serde::Serialize;
use tokio::runtime::Handle;
use tokio::sync::watch;

use crate::refusal::{Problem, Refusal};

/// Time for which a tab and its job stay without a page: that of loading it again, with room.
pub(crate) const RETURN: Duration = Duration::from_secs(10);
/// Number of reported progress steps.
const STEPS: f64 = 1000.0;

/// Progress of a job.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub(crate) enum Progress {
    Running {
        /// Current stage; `None` if the job has only one.
        stage: Option<&'static str>,
        /// Completed share of the stage, 0 to 1.
        share: f64,
        /// Error of the model so far; `None` if the stage reports none.
        error: Option<ErrorSeen>,
    },
    Done,
    Cancelled,
    Failed {
        problems: Vec<Problem>,
    },
}

/// Error of the signal that the model explains worst while it is estimated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ErrorSeen {
    signal: &'static str,
    /// Rms over the noise floor.
    floors: f64,
}

/// Time for which a job runs at most.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Span {
    /// Until its page is left: a comparison, a run of the loop, a report.
    Page,
    /// Until its tab closes: a diagnosis, a fit, a planned experiment.
    Tab,
}

/// Running job.
pub(crate) struct Job {
    pub(crate) number: u64,
    span: Span,
    is_cancelled: AtomicBool,
    progress: watch::Sender<Progress>,
}

impl Job {
    fn new(span: Span) -> Self {
        static NUMBERS: AtomicU64 = AtomicU64::new(1);
        Self {
            number: NUMBERS.fetch_add(1, Ordering::Relaxed),
            span,
            is_cancelled: AtomicBool::new(false),
            progress: watch::Sender::new(Progress::Running {
                stage: None,
                share: 0.0,
                error: None,
            }),
        }
    }

    /// Starts `work` on its own thread, as soon as `take_place` returns a place. The work asks its job regularly
    /// whether to continue.
    pub(crate) fn start<P>(
        span: Span,
        take_place: impl FnOnce() -> P + Send + 'static,
        work: impl FnOnce(&Self) -> Result<(), Refusal> + Send + 'static,
    ) -> Arc<Self> {
        let job = Arc::new(Self::new(span));
        let worker = Arc::clone(&job);
        let watched = Arc::clone(&job);
        tokio::spawn(async move {
            let running = tokio::task::spawn_blocking(move || {
                let _place = take_place();
                let ended = work(&worker);
                worker.end(ended);
            });
            if running.await.is_err() {
                let problem = Problem::new(
                    "E-WEB-INTERNAL",
                    "internal error of the program, not of the data; please report it with the log",
                );
                watched.end(Err(problem.into()));
            }
        });
        job
    }

    fn end(&self, ended: Result<(), Refusal>) {
        self.progress.send_replace(match ended {
            _ if self.is_cancelled() => Progress::Cancelled,
            Ok(()) => Progress::Done,
            Err(refusal) => Progress::Failed {
                problems: refusal.problems,
            },
        });
    }

    pub(crate) fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    /// Reports the progress (0 to 1), and returns whether to continue.
    pub(crate) fn goes_on(&self, share: f64) -> bool {
        self.report(None, share, None);
        !self.is_cancelled()
    }

    /// Reports the progress of a diagnosis, which has stages and reports from several threads, and returns whether to
    /// continue.
    pub(crate) fn watch(&self, seen: diagnosis::Progress) -> ControlFlow<()> {
        let error = seen.error.map(|error| ErrorSeen {
            signal: error.signal,
            floors: error.floors,
        });
        self.report(Some(seen.stage), seen.done, error);
        if self.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn report(&self, stage: Option<&'static str>, share: f64, error: Option<ErrorSeen>) {
        let step = |share: f64| (share * STEPS) as u64;
        self.progress.send_if_modified(|progress| {
            let Progress::Running {
                stage: last,
                share: before,
                error: last_error,
            } = progress
            else {
                return false;
            };
            let is_news = *last != stage || step(*before) != step(share) || *last_error != error;
            if is_news {
                *progress = Progress::Running {
                    stage,
                    share,
                    error,
                };
            }
            is_news
        });
    }

    /// Returns the progress as events; the last one is the end. A client that stops listening before ends the job; one of
    /// a tab if no other client listens after [`RETURN`].
    pub(crate) fn events(
        self: &Arc<Self>,
    ) -> Sse<impl Stream<Item = Result<Event, Infallible>> + use<>> {
        let listener = Listener {
            progress: self.progress.subscribe(),
            job: Arc::clone(self),
            is_first: true,
            has_ended: false,
        };
        let events = stream::unfold(listener, async |mut listener| {
            let progress = listener.next().await?;
            let event = Event::default().json_data(progress).unwrap_or_default();
            Some((Ok(event), listener))
        });
        Sse::new(events).keep_alive(KeepAlive::new().interval(Duration::from_secs(5)))
    }
}

struct Listener {
    job: Arc<Job>,
    progress: watch::Receiver<Progress>,
    is_first: bool,
    has_ended: bool,
}

impl Listener {
    async fn next(&mut self) -> Option<Progress> {
        if self.has_ended {
            return None;
        }
        if !self.is_first {
            self.progress.changed().await.ok()?;
        }
        self.is_first = false;
        let progress = self.progress.borrow_and_update().clone();
        self.has_ended = !matches!(progress, Progress::Running { .. });
        Some(progress)
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        if self.has_ended {
            return;
        }
        let job = Arc::clone(&self.job);
        match (job.span, Handle::try_current()) {
            (Span::Tab, Ok(runtime)) => {
                runtime.spawn(async move {
                    tokio::time::sleep(RETURN).await;
                    if job.progress.receiver_count() == 0 {
                        job.cancel();
                    }
                });
            }
            _ => job.cancel(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_runtime(test: impl Future<Output = ()>) {
        tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .build()
            .unwrap()
            .block_on(test);
    }

    async fn last_of(job: &Arc<Job>) -> Progress {
        let mut progress = job.progress.subscribe();
        let ended = progress
            .wait_for(|progress| !matches!(progress, Progress::Running { .. }))
            .await;
        ended.unwrap().clone()
    }

    #[test]
    fn a_job_ends_with_what_came_of_it() {
        in_runtime(async {
            assert_eq!(
                last_of(&Job::start(Span::Page, || (), |_| Ok(()))).await,
                Progress::Done
            );
            let failing = Job::start(Span::Page, || (), |_| Err(Refusal::value("no")));
            assert!(matches!(last_of(&failing).await, Progress::Failed { .. }));
            let panicking = Job::start(Span::Page, || (), |_| panic!("on purpose"));
            let Progress::Failed { problems } = last_of(&panicking).await else {
                panic!("the panic was not reported");
            };
            assert_eq!(problems[0].code, "E-WEB-INTERNAL");
        });
    }

    /// Returns a job that lasts until it is cancelled.
    fn endless(span: Span) -> Arc<Job> {
        Job::start(
            span,
            || (),
            |job| {
                while job.goes_on(0.5) {
                    std::thread::yield_now();
                }
                Ok(())
            },
        )
    }

    #[test]
    fn a_job_of_a_page_whose_listener_goes_away_is_cancelled() {
        in_runtime(async {
            let job = endless(Span::Page);
            drop(job.events());
            assert_eq!(last_of(&job).await, Progress::Cancelled);
        });
    }

    #[tokio::test(start_paused = true)]
    async fn a_job_of_a_tab_waits_for_the_page_that_is_loaded_again_and_not_longer() {
        let later = async || {
            tokio::task::yield_now().await;
            tokio::time::advance(2 * RETURN).await;
            tokio::task::yield_now().await;
        };
        let job = endless(Span::Tab);
        drop(job.events());
        let again = job.events();
        later().await;
        assert!(!job.is_cancelled());
        drop(again);
        assert!(!job.is_cancelled());
        later().await;
        assert_eq!(last_of(&job).await, Progress::Cancelled);
    }
}
