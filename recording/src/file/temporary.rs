//! Temporary files: their creation, and the removal of those left by killed processes.
//!
//! A process keeps a lock on its temporary file while it runs, and the system releases the lock at any end of the
//! process. A process number in the name would be wrong in a folder shared by containers or hosts.

use std::ffi::OsStr;
use std::fs::{self, DirEntry, File, TryLockError};
use std::io;
use std::path::Path;

use tempfile::NamedTempFile;

/// Prefix of all temporary files of this crate.
const PREFIX: &str = ".retarder-unfinished-";
/// Number of letters and digits after the prefix.
const RANDOM_CHARACTERS: usize = 8;
/// Maximum number of tries: a cleaning process can remove a file between its creation and its lock, but this hardly
/// occurs twice.
const TRIES: usize = 16;

/// Creates a locked temporary file in `folder`.
pub(super) fn begin(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM_CHARACTERS);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // Without this only the owner could read the file; the umask still applies.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    for _ in 1..TRIES {
        let temporary = builder.tempfile_in(folder)?;
        match temporary.as_file().try_lock() {
            Ok(()) if temporary.path().symlink_metadata().is_ok() => return Ok(temporary),
            Ok(()) | Err(TryLockError::WouldBlock) => {}
            // A file system without locks: no process can lock the file, so none removes it.
            Err(TryLockError::Error(_)) => return Ok(temporary),
        }
    }
    builder.tempfile_in(folder)
}

/// Removes the temporary files of ended processes. A file that cannot be removed stays and does no harm.
pub(super) fn remove_leftovers(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(is_ours) {
        let path = entry.path();
        let Ok(file) = File::open(&path) else {
            continue;
        };
        if file.try_lock().is_ok() {
            // The lock is kept until the file is removed, so that no other process begins to use it in between.
            let _ = fs::remove_file(&path);
        }
    }
}

/// Returns whether an entry of a folder is a regular file, no link, with a name created by [`begin`].
fn is_ours(entry: &DirEntry) -> bool {
    let is_name = |name: &OsStr| {
        let random = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
        random.is_some_and(|random| {
            random.len() == RANDOM_CHARACTERS
                && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
        })
    };
    is_name(&entry.file_name()) && entry.file_type().is_ok_and(|kind| kind.is_file())
}
