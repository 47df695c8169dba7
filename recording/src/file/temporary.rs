//! Temporary files: how they begin, and what becomes of those that a killed process left.
//!
//! A process holds a lock on its temporary file as long as it lives, and the system lets go of it however the process
//! ends. A number of the process in the name would be wrong in a folder that containers or hosts share.

use std::ffi::OsStr;
use std::fs::{self, DirEntry, File, TryLockError};
use std::io;
use std::path::Path;

use tempfile::NamedTempFile;

/// What every temporary file of ours begins with.
const PREFIX: &str = ".retarder-unfinished-";
/// Letters and digits that follow.
const RANDOM_CHARACTERS: usize = 8;
/// Another process that cleans up can take a file between its beginning and its lock; hardly twice.
const TRIES: usize = 16;

/// Begins a locked temporary file in `folder`.
pub(super) fn begin(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM_CHARACTERS);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // Without this the file would be readable by its owner only; the umask still applies.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    for _ in 1..TRIES {
        let temporary = builder.tempfile_in(folder)?;
        match temporary.as_file().try_lock() {
            Ok(()) if temporary.path().symlink_metadata().is_ok() => return Ok(temporary),
            Ok(()) | Err(TryLockError::WouldBlock) => {}
            // A file system without locks: nobody can lock it there, so nobody removes it.
            Err(TryLockError::Error(_)) => return Ok(temporary),
        }
    }
    builder.tempfile_in(folder)
}

/// Removes the temporary files of processes that run no more. What cannot be removed stays: it is in nobody's way.
pub(super) fn remove_leftovers(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(is_ours) {
        let path = entry.path();
        let Ok(file) = File::open(&path) else {
            continue;
        };
        if file.try_lock().is_ok() {
            // The lock is held until the file is gone, so that nobody begins to use it in between.
            let _ = fs::remove_file(&path);
        }
    }
}

/// Whether a folder's entry is a regular file, no link, with a name that [`begin`] makes.
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
