mod identity;
mod replacement;
mod temporary;

use std::fs;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

pub use identity::FileIdentity;

/// An output file that appears whole or not at all.
///
/// What is written goes to a temporary file in the same folder; [`AtomicFile::commit`] renames it. Dropped before
/// that, on an error or a panic, it leaves nothing behind and an older file of that name unchanged. A temporary file
/// that a killed process left is removed by the next [`AtomicFile`] in that folder.
///
/// A file that is replaced keeps its mode, its owner and its hard links; links to it are followed.
#[derive(Debug)]
pub struct AtomicFile {
    temporary: BufWriter<NamedTempFile>,
    target: PathBuf,
    may_replace: bool,
}

impl AtomicFile {
    /// Begins the file that will be `path`.
    ///
    /// # Errors
    /// The folder does not exist or is not writable, or `path` is something other than a regular file, or is
    /// write-protected.
    pub fn create(path: impl AsRef<Path>) -> io::Result<Self> {
        Self::begin(path.as_ref(), true)
    }

    /// Begins the file that will be `path`, where no file may be yet, nor when it is committed.
    ///
    /// # Errors
    /// Those of [`AtomicFile::create`], and a file that exists.
    pub fn create_new(path: impl AsRef<Path>) -> io::Result<Self> {
        Self::begin(path.as_ref(), false)
    }

    fn begin(path: &Path, may_replace: bool) -> io::Result<Self> {
        let target = writable_place(path)?;
        if !may_replace && target.symlink_metadata().is_ok() {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        temporary::remove_leftovers(folder);
        Ok(Self {
            temporary: BufWriter::with_capacity(1 << 16, temporary::begin(folder)?),
            target,
            may_replace,
        })
    }

    /// Makes the file visible under its name, after its bytes have reached the disk.
    ///
    /// # Errors
    /// Disk full, folder gone: then an older file is still untouched, unless it has several names.
    pub fn commit(self) -> io::Result<()> {
        let temporary = self
            .temporary
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        temporary.as_file().sync_all()?;
        if !self.may_replace {
            temporary
                .persist_noclobber(&self.target)
                .map_err(|failure| failure.error)?;
            return Ok(());
        }
        replacement::replace(temporary, &self.target)
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.temporary.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.temporary.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.temporary.seek(position)
    }
}

/// Writes the file `path` with `write`, whole or not at all. See [`AtomicFile`].
///
/// # Errors
/// Those of `write`, and those of [`AtomicFile`].
pub fn write_file_atomically<E: From<io::Error>>(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut AtomicFile) -> Result<(), E>,
) -> Result<(), E> {
    let mut file = AtomicFile::create(path)?;
    write(&mut file)?;
    Ok(file.commit()?)
}

/// The place that `path` leads to. A rename onto a link would replace the link, and one onto `/dev/null` the device; a
/// rename asks nobody whether the file may be written.
fn writable_place(path: &Path) -> io::Result<PathBuf> {
    let refused = |kind, reason: &str| {
        let message = format!("{} {reason}: choose another output", path.display());
        Err(io::Error::new(kind, message))
    };
    match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => {
            refused(io::ErrorKind::InvalidInput, "is not a regular file")
        }
        Ok(metadata) if metadata.permissions().readonly() => {
            refused(io::ErrorKind::PermissionDenied, "is write-protected")
        }
        Ok(_) => fs::canonicalize(path),
        Err(_) => identity::destination(path),
    }
}
