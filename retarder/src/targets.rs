//! Destinations of results.

use std::io;
use std::path::{Path, PathBuf};

use recording::AtomicFile;

/// Destinations of results other than the text; `-` is the standard output.
#[derive(Debug, Default)]
pub(crate) struct Targets {
    pub(crate) json: Option<PathBuf>,
    pub(crate) html: Option<PathBuf>,
    pub(crate) recording: Option<PathBuf>,
    /// The refined plant file, or that with the missing flow.
    pub(crate) plant: Option<PathBuf>,
    /// Controller file.
    pub(crate) controller: Option<PathBuf>,
    /// Mapping of the columns of a log.
    pub(crate) mapping: Option<PathBuf>,
    pub(crate) existing: Existing,
}

/// Treatment of a file that has the name of an output.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Existing {
    /// The file is replaced; its mode, owner and hard links stay.
    #[default]
    Replace,
    /// The file is kept, and the output is refused.
    Keep,
}

impl Existing {
    /// Begins the file that becomes `path`.
    pub(crate) fn begin(self, path: &Path) -> io::Result<AtomicFile> {
        match self {
            Self::Replace => AtomicFile::create(path),
            Self::Keep => AtomicFile::create_new(path),
        }
    }
}

/// Returns whether a target is the standard output.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}
