//! Tests with `kill -9` at any moment: existing files of the user stay complete.
//!
//! [`diagnose`] kills a command that writes two files; [`serve`] kills the server of the page while it receives logs
//! and computes. The moments are drawn from a seed; the requirements apply at every moment.

pub mod diagnose;
pub mod serve;

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Loss of data, or the reason why it cannot be checked.
#[derive(Debug, Error)]
pub enum Loss {
    /// An input file changed.
    #[error("kill {kill}: {} changed", .path.display())]
    Input {
        /// Number of the kill.
        kill: u64,
        /// File.
        path: PathBuf,
    },
    /// An output is neither the old file nor the new one.
    #[error("kill {kill}: {} is neither the old file nor the new one", .path.display())]
    Torn {
        /// Number of the kill.
        kill: u64,
        /// File.
        path: PathBuf,
    },
    /// An unexpected file exists.
    #[error("kill {kill}: {} is left after the next run", .path.display())]
    Left {
        /// Number of the kill.
        kill: u64,
        /// File.
        path: PathBuf,
    },
    /// Data that the server had accepted is missing.
    #[error("kill {kill}: {what}")]
    Forgotten {
        /// Number of the kill.
        kill: u64,
        /// Missing data.
        what: String,
    },
    /// The program does not run, or its folder cannot be read.
    #[error("kill {kill}: {source}")]
    Run {
        /// Number of the kill.
        kill: u64,
        /// Cause.
        source: io::Error,
    },
}

/// Counts of the kills.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Kills {
    /// Kills during the work of the program.
    pub at_work: u64,
    /// Kills after its end.
    pub too_late: u64,
    /// Kills that left a temporary file until the next run.
    pub with_leavings: u64,
    /// Kills after which the new output existed already, or an unanswered request had been carried out.
    pub with_news: u64,
}

fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with(".unfinished-")
        || path
            .parent()
            .is_some_and(|folder| folder.ends_with("incoming"))
}
