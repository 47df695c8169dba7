use std::fs;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// An output file that appears whole or not at all.
///
/// What is written goes to a temporary file in the same folder; [`AtomicFile::commit`] renames it. Dropped before
/// that, on an error or a panic, it leaves nothing behind and an older file of that name as it was.
#[derive(Debug)]
pub struct AtomicFile {
    temporary: BufWriter<NamedTempFile>,
    target: PathBuf,
}

impl AtomicFile {
    /// Begins the file that will be `path`.
    ///
    /// # Errors
    /// The folder does not exist or is not writable, or `path` is something other than a regular file.
    pub fn create(path: impl AsRef<Path>) -> io::Result<Self> {
        let target = resolve_link(path.as_ref())?;
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".unfinished-");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // Without this the file would be readable by its owner only; the umask still applies.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let temporary = builder.tempfile_in(folder)?;
        Ok(Self {
            temporary: BufWriter::with_capacity(1 << 16, temporary),
            target,
        })
    }

    /// Makes the file visible under its name, after its bytes have reached the disk.
    ///
    /// # Errors
    /// Disk full, folder gone: then an older file is still untouched.
    pub fn commit(self) -> io::Result<()> {
        let temporary = self
            .temporary
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        temporary.as_file().sync_all()?;
        temporary
            .persist(&self.target)
            .map_err(|failure| failure.error)?;
        Ok(())
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

/// A rename onto a link would replace the link, and one onto `/dev/null` the device.
fn resolve_link(path: &Path) -> io::Result<PathBuf> {
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => fs::canonicalize(path),
        Ok(_) => {
            let message = format!(
                "{} is not a regular file: choose another output",
                path.display()
            );
            Err(io::Error::new(io::ErrorKind::InvalidInput, message))
        }
        Err(_) => Ok(path.to_path_buf()),
    }
}
