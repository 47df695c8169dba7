//! Where results go.

use std::path::{Path, PathBuf};

use recording::AtomicFile;

use crate::failure::Failure;

/// Where results go besides the text; `-` is the standard output.
#[derive(Debug, Default)]
pub(crate) struct Targets {
    pub(crate) json: Option<PathBuf>,
    pub(crate) html: Option<PathBuf>,
    pub(crate) recording: Option<PathBuf>,
    /// The refined plant file.
    pub(crate) plant: Option<PathBuf>,
}

impl Targets {
    /// Refuses a file that cannot be written, before any work is done for it.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let paths = [&self.json, &self.html, &self.recording, &self.plant];
        let files = paths.into_iter().flatten();
        for path in files.filter(|path| !is_standard_output(path)) {
            // Begun and dropped: nothing stays.
            AtomicFile::create(path).map_err(|error| Failure::write(Some(path), error))?;
        }
        Ok(())
    }
}

/// Whether a target is the standard output.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}
