//! Progress on the standard error, if that is a terminal.

use std::io::Read;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Bar or spinner that is removed on drop.
pub(crate) struct Progress(ProgressBar);

/// Steps of a bar that shows a share.
const STAGE: u64 = 1000;
const TICK: Duration = Duration::from_millis(100);

impl Progress {
    /// Creates a spinner for work of unknown length.
    pub(crate) fn of_unknown_length(what: &'static str) -> Self {
        Self::new(None, what, "{spinner} {msg} {elapsed}")
    }

    /// Creates a bar for `count` steps.
    pub(crate) fn of_count(what: &'static str, count: u64) -> Self {
        let template = "{spinner} {msg} {wide_bar} {pos}/{len}, {eta} left";
        Self::new(Some(count), what, template)
    }

    /// Creates a bar for stages of unequal length, each with its completed share.
    pub(crate) fn of_stages() -> Self {
        let template =
            "{spinner} {msg} {wide_bar} {percent} %, {eta} left of this step, {elapsed} in all";
        let progress = Self::new(Some(STAGE), "reading the logs", template);
        progress.0.set_position(0);
        progress
    }

    /// Creates a bar for input of `size` bytes, if the size is known.
    pub(crate) fn of_bytes(what: &'static str, size: Option<u64>) -> Self {
        let template = match size {
            Some(_) => "{spinner} {msg} {wide_bar} {bytes}/{total_bytes}, {eta} left",
            None => "{spinner} {msg} {bytes}, {elapsed}",
        };
        Self::new(size, what, template)
    }

    fn new(length: Option<u64>, what: &'static str, template: &str) -> Self {
        let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template(template)
            .unwrap_or_else(|_| ProgressStyle::default_spinner());
        bar.set_style(style);
        bar.set_message(what);
        if !bar.is_hidden() {
            bar.enable_steady_tick(TICK);
        }
        Self(bar)
    }

    /// Counts one completed step.
    pub(crate) fn step(&self) {
        self.0.inc(1);
    }

    /// Counts steps that were completed before.
    pub(crate) fn skip(&self, steps: u64) {
        self.0.inc(steps);
        self.0.reset_eta();
    }

    /// Shows the completed share `done` of `stage`, 0 to 1.
    pub(crate) fn reach(&self, stage: &'static str, done: f64) {
        if self.0.message() != stage {
            self.0.set_message(stage);
            self.0.reset_eta();
        }
        self.0.set_position((done * STAGE as f64) as u64);
    }

    /// Counts the bytes that are read.
    pub(crate) fn watch<R: Read>(&self, reader: R) -> impl Read + use<R> {
        self.0.wrap_read(reader)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
