//! Where results go.

use std::path::{Path, PathBuf};

/// Where results go besides the text; `-` is the standard output.
#[derive(Debug, Default)]
pub(crate) struct Targets {
    pub(crate) json: Option<PathBuf>,
    pub(crate) html: Option<PathBuf>,
    pub(crate) recording: Option<PathBuf>,
    /// The refined plant file.
    pub(crate) plant: Option<PathBuf>,
}

/// Whether a target is the standard output.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}
