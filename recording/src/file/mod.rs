mod identity;
mod replacement;
mod temporary;

use std::fs;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

pub use identity::FileIdentity;

/// Output file that appears completely or not at all.
///
/// The data goes to a temporary file in the same folder; [`AtomicFile::commit`] renames it. If it is dropped before, on
/// an error or a panic, no temporary file is left and an older file of that name is unchanged. A temporary file of a
/// killed process is removed by the next [`AtomicFile`] in that folder.
///
/// A replaced file keeps its mode, its owner and its hard links; symbolic links to it are followed.
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
    /// Returns an error if the folder does not exist or is not writable, or if `path` is not a regular file or is
    /// write-protected.
    pub fn create(path: impl AsRef<Path>) -> io::Result<Self> {
        Self::begin(path.as_ref(), true)
    }

    /// Begins the file that will be `path`. No file may exist there now or at the commit.
    ///
    /// # Errors
    /// Returns the errors of [`AtomicFile::create`], or an error if the file exists.
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
    /// Returns an error for a full disk or a missing folder; an older file is then unchanged, unless it has several
    /// names.
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

/// Writes the file `path` with `write`, completely or not at all. See [`AtomicFile`].
///
/// # Errors
/// Returns the errors of `write` and those of [`AtomicFile`].
pub fn write_file_atomically<E: From<io::Error>>(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut AtomicFile) -> Result<(), E>,
) -> Result<(), E> {
    let mut file = AtomicFile::create(path)?;
    write(&mut file)?;
    Ok(file.commit()?)
}

/// Returns the place that `path` leads to, if it is writable. A rename to a link would replace the link, and one to
/// `/dev/null` would replace the device. A rename does not check whether the file may be written.
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
