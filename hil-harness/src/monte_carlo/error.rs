//! Reasons why a batch has no table.

use std::io;
use std::path::PathBuf;

use super::settings::Difference;
use crate::rigs::RigError;

/// Reason why a batch has no table.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MonteCarloError {
    /// A rig could not be run.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The journal cannot be read or written.
    #[error("{}: {error}; check the folder, its rights and its space", path.display())]
    Journal {
        /// Path of the journal.
        path: PathBuf,
        /// Error of the file.
        error: io::Error,
    },
    /// The file at the path of the journal is another file.
    #[error("{}: not the unfinished part of a run with --rigs-out; move it away, or name another --rigs-out", path.display())]
    NoJournal {
        /// Path of the file.
        path: PathBuf,
    },
    /// Another process works on the same output.
    #[error("{}: another run is writing it; wait for its end, or name another --rigs-out", path.display())]
    InUse {
        /// Path of the journal.
        path: PathBuf,
    },
    /// The journal belongs to a run with other settings.
    #[error(
        "{}: the unfinished part of a run with other settings: {} `{}` there and `{}` now; repeat the command of that run, \
         remove the part, or name another --rigs-out", path.display(), difference.name, difference.lines[0],
        difference.lines[1]
    )]
    OtherSettings {
        /// Path of the journal.
        path: PathBuf,
        /// First different setting: of the journal, and of this run.
        difference: Difference,
    },
    /// A rig of the journal gives another row now.
    #[error(
        "{}: rig {rig} has other figures than in this program, so another build wrote it; remove the part, and run all rigs \
         with one build", path.display()
    )]
    OtherProgram {
        /// Path of the journal.
        path: PathBuf,
        /// Number of the rig.
        rig: u32,
    },
    /// A stored chunk cannot be read.
    #[error("{}: {reason}; remove it and run the command again", path.display())]
    DamagedJournal {
        /// Path of the journal.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// The table cannot be written.
    #[error("the table cannot be written: {0}")]
    Write(io::Error),
    /// The run was stopped; its journal keeps the finished rigs.
    #[error(
        "interrupted; {done} of {rigs} rigs are in {}, and the same command continues there", path.display()
    )]
    Interrupted {
        /// Path of the journal.
        path: PathBuf,
        /// Number of finished rigs.
        done: u32,
        /// Number of rigs of the shard.
        rigs: u32,
    },
}
