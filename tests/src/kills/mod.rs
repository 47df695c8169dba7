//! `kill -9` at any moment: what a person owned before is there afterwards, whole.
//!
//! [`diagnose`] kills a command that writes two files; [`serve`] kills the server of the page while it takes logs and
//! computes. The moments are drawn from a seed; what must hold, holds at every moment.

pub mod diagnose;
pub mod serve;

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// What was lost, or why it cannot be told.
#[derive(Debug, Error)]
pub enum Loss {
    /// A file that is read only is not what it was.
    #[error("kill {kill}: {} changed", .path.display())]
    Input {
        /// Number of the kill.
        kill: u64,
        /// The file.
        path: PathBuf,
    },
    /// An output is neither what it was before nor what the program writes.
    #[error("kill {kill}: {} is neither the old file nor the new one", .path.display())]
    Torn {
        /// Number of the kill.
        kill: u64,
        /// The file.
        path: PathBuf,
    },
    /// A file lies there that nobody asked for.
    #[error("kill {kill}: {} is left after the next run", .path.display())]
    Left {
        /// Number of the kill.
        kill: u64,
        /// The file.
        path: PathBuf,
    },
    /// What the server had taken is not there any more.
    #[error("kill {kill}: {what}")]
    Forgotten {
        /// Number of the kill.
        kill: u64,
        /// What is missing.
        what: String,
    },
    /// The program does not run, or its folder cannot be read.
    #[error("kill {kill}: {source}")]
    Run {
        /// Number of the kill.
        kill: u64,
        /// Why.
        source: io::Error,
    },
}

/// What a number of kills met.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Kills {
    /// Kills that met the program at work.
    pub at_work: u64,
    /// Kills that came when it had ended.
    pub too_late: u64,
    /// Kills after which a temporary file lay there, until the next run.
    pub with_leavings: u64,
    /// Kills after which the new output was there already, or a request had been taken that was not answered.
    pub with_news: u64,
}

fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with(".unfinished-")
        || path
            .parent()
            .is_some_and(|folder| folder.ends_with("incoming"))
}
