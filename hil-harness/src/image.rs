//! The image's file: where it is, and the texts of its log.

use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use hil_protocol::crc32;

use crate::image_log::{ImageLog, ImageLogError};

/// An image with the texts of its log.
#[derive(Debug)]
pub struct Image {
    path: PathBuf,
    crc: u32,
    log: ImageLog,
}

/// Where `cargo xtask image` puts the image, below cargo's target folder.
pub const PLACE: &str = "arm/thumbv7em-none-eabihf/firmware/firmware";

/// Why there is no image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// Not built yet.
    #[error(
        "there is no image at {PLACE} below cargo's target folder; build it with `cargo xtask image`, or name its ELF file \
         with --image"
    )]
    NotBuilt,
    /// The file cannot be read.
    #[error("{}: {error}; build it with `cargo xtask image`", path.display())]
    Read {
        /// Where it was looked for.
        path: PathBuf,
        /// What the operating system says.
        error: io::Error,
    },
    /// Not the file of an image.
    #[error("{}: {error}", path.display())]
    Log {
        /// Which file.
        path: PathBuf,
        /// Why.
        error: ImageLogError,
    },
}

impl Image {
    /// The image in this file, or the one that `cargo xtask image` has built.
    ///
    /// # Errors
    /// There is none, or it is no ELF file.
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

    /// Its file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its file's name and checksum, for the record of a run.
    pub fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or(self.path.as_os_str());
        format!("{} (CRC-32 {:08x})", name.to_string_lossy(), self.crc)
    }

    /// The texts of its log.
    pub fn into_log(self) -> ImageLog {
        self.log
    }
}

/// The image below the target folder that this program was built into, or below the present folder's.
fn built() -> Option<PathBuf> {
    let program = env::current_exe().unwrap_or_default();
    let above = program.ancestors().map(|folder| folder.join(PLACE));
    let here = Path::new("target").join(PLACE);
    above.chain([here]).find(|path| path.is_file())
}
