//! Script that replaces the command `retarder` in tests of the programs that call it.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

/// Creates a command in `folder` that writes `says` into the file of its last argument, and its arguments as a line of
/// `calls`.
///
/// # Panics
/// Panics if the folder cannot be written.
pub fn stand_in(folder: &Path, says: &str) -> PathBuf {
    let path = folder.join("stand-in");
    let script = format!(
        "#!/bin/sh\necho \"$*\" >> {}/calls\nfor last; do :; done\ncat > \"$last\" <<'END'\n{says}\nEND\n",
        folder.display()
    );
    fs::write(&path, script).expect("the folder can be written");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("it is ours");
    path
}
