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
    /// Refuses a file that cannot be written, and two results for the standard output, before any work is done for them.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let options = [
            ("--out", &self.recording),
            ("--out", &self.plant),
            ("--html", &self.html),
            ("--json", &self.json),
        ];
        let paths = options
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)));
        let (standard, files): (Vec<_>, Vec<_>) =
            paths.partition(|(_, path)| is_standard_output(path));
        if let [(option, _), _, ..] = standard[..] {
            return Err(Failure::TwoOnStandardOutput { option });
        }
        for (_, path) in files {
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
