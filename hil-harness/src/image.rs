//! File of the image: its place, and the texts of its log.

use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use hil_protocol::crc32;

use crate::image_log::{ImageLog, ImageLogError};

/// Image with the texts of its log.
#[derive(Debug)]
pub struct Image {
    path: PathBuf,
    crc: u32,
    log: ImageLog,
}

/// Place of the image built by `cargo xtask image`, below cargo's target folder.
pub const PLACE: &str = "arm/thumbv7em-none-eabihf/firmware/firmware";

/// Reason why there is no image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The image is not built yet.
    #[error(
        "there is no image at {PLACE} below cargo's target folder; build it with `cargo xtask image`, or name its ELF file \
         with --image"
    )]
    NotBuilt,
    /// The file cannot be read.
    #[error("{}: {error}; build it with `cargo xtask image`", path.display())]
    Read {
        /// Path that was tried.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The file is not that of an image.
    #[error("{}: {error}", path.display())]
    Log {
        /// Path of the file.
        path: PathBuf,
        /// Error of the log.
        error: ImageLogError,
    },
}

impl Image {
    /// Returns the image in this file, or the one built by `cargo xtask image`.
    ///
    /// # Errors
    /// Returns an error if there is none, or it is no ELF file.
    pub fn find(named: Option<&Path>) -> Result<Self, ImageError> {
        match named {
            Some(path) => Self::read(path),
            None => Self::read(&built().ok_or(ImageError::NotBuilt)?),
        }
    }

    fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = fs::read(path).map_err(|error| ImageError::Read {
            path: path.to_owned(),
            error,
        })?;
        let log = ImageLog::of_elf(&bytes).map_err(|error| ImageError::Log {
            path: path.to_owned(),
            error,
        })?;
        Ok(Self {
            path: path.to_owned(),
            crc: crc32::digest(&bytes),
            log,
        })
    }

    /// Returns the path of its file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns name and checksum of the file, for the record of a run.
    pub fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or(self.path.as_os_str());
        format!("{} (CRC-32 {:08x})", name.to_string_lossy(), self.crc)
    }

    /// Returns the texts of its log.
    pub fn into_log(self) -> ImageLog {
        self.log
    }
}

/// Returns the image below the target folder of this program, or below that of the present folder.
fn built() -> Option<PathBuf> {
    let program = env::current_exe().unwrap_or_default();
    let above = program.ancestors().map(|folder| folder.join(PLACE));
    let here = Path::new("target").join(PLACE);
    above.chain([here]).find(|path| path.is_file())
}
