//! Replacement of an older file by a temporary one, which takes over owner and mode.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

use tempfile::NamedTempFile;

/// Replaces the content of `target` by that of `temporary`.
///
/// A rename is atomic, and the new file gets mode and owner of the old one. But a rename separates the names of a file
/// with several hard links: the other names would keep the old content, unnoticed. In this case the content, which is
/// already complete on the disk, is copied into the file itself. The same happens where the owner cannot be changed.
pub(super) fn replace(temporary: NamedTempFile, target: &Path) -> io::Result<()> {
    match fs::metadata(target) {
        Ok(older) if !takes_over(temporary.as_file(), &older)? => {
            copy_into(temporary.into_file(), target)
        }
        _ => {
            temporary.persist(target).map_err(|failure| failure.error)?;
            Ok(())
        }
    }
}

/// Gives the temporary file owner and mode of the older one; returns whether a rename then loses nothing.
#[cfg(unix)]
fn takes_over(temporary: &File, older: &Metadata) -> io::Result<bool> {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
    const MODE: u32 = 0o777;
    if older.nlink() > 1 {
        return Ok(false);
    }
    let own = temporary.metadata()?;
    let owner = (older.uid(), older.gid());
    if owner != (own.uid(), own.gid()) && fchown(temporary, Some(owner.0), Some(owner.1)).is_err() {
        return Ok(false);
    }
    temporary.set_permissions(fs::Permissions::from_mode(older.mode() & MODE))?;
    Ok(true)
}

#[cfg(not(unix))]
fn takes_over(_: &File, _: &Metadata) -> io::Result<bool> {
    Ok(true)
}

/// Writes the part beyond the older length first: if the disk is full, it is cut off again and nothing is lost.
fn copy_into(mut content: File, target: &Path) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(target)?;
    let length = content.metadata()?.len();
    let older_length = file.metadata()?.len();
    content.seek(SeekFrom::Start(older_length.min(length)))?;
    file.seek(SeekFrom::End(0))?;
    if let Err(error) = io::copy(&mut content, &mut file) {
        file.set_len(older_length)?;
        return Err(error);
    }
    content.rewind()?;
    file.rewind()?;
    io::copy(&mut content.take(older_length), &mut file)?;
    file.set_len(length)?;
    file.sync_all()
}
