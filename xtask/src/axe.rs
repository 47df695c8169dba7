//! axe-core, with which the tests of the page check its accessibility: fetched by npm, compared with its digest, and
//! kept in the target folder. It is under the MPL 2.0, and no part of a program.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use sha2::{Digest, Sha512};

use crate::failure::Failure;
use crate::workspace::{find_program, target_dir};
use crate::{packages, process};

/// Package with its version.
const PACKAGE: &str = "axe-core@4.14.1";
/// File that npm writes.
const ARCHIVE: &str = "axe-core-4.14.1.tgz";
/// SHA-512 of that file, as the registry states it.
const SHA_512: &str = "1477dafa598d8d065f273d6af302aa203c02e83131707b7fa648cd41bd3d6b73\
    4f8c22a0dab86ee6a6f64b8afbe804b214d36db85a2826965edfb3a0b9d546b5";
/// Timeout of the download.
const DEADLINE: Duration = Duration::from_secs(300);

/// Fetches axe-core if it is missing, and unpacks it where the tests read it: `tmp/axe-core/axe.min.js` in the target
/// folder.
pub(crate) fn ready() -> Result<(), Failure> {
    // The folder that cargo passes to tests as `CARGO_TARGET_TMPDIR`.
    let folder = target_dir().join("tmp").join("axe-core");
    let of_folder = |source| Failure::File {
        path: folder.clone(),
        source,
    };
    fs::create_dir_all(&folder).map_err(of_folder)?;
    if !is_genuine(&folder.join(ARCHIVE)) {
        if find_program("npm").is_none() {
            packages::install("npm", &["npm"])?;
        }
        let mut fetch = Command::new("npm");
        fetch.args(["pack", PACKAGE, "--silent"]);
        process::run(fetch.current_dir(&folder), DEADLINE)?;
    }
    if !is_genuine(&folder.join(ARCHIVE)) {
        return Err(Failure::NotGenuine {
            path: folder.join(ARCHIVE),
            expected: SHA_512,
        });
    }
    let mut unpack = Command::new("tar");
    unpack.args([
        "-xzf",
        ARCHIVE,
        "--strip-components=1",
        "package/axe.min.js",
    ]);
    process::run(unpack.current_dir(&folder), DEADLINE)
}

/// Returns whether the file is there and has the digest.
fn is_genuine(path: &Path) -> bool {
    fs::read(path).is_ok_and(|bytes| is_package(&bytes))
}

fn is_package(bytes: &[u8]) -> bool {
    let digest = Sha512::digest(bytes);
    let hex: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    hex == SHA_512
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_file_is_not_the_package() {
        assert_eq!(SHA_512.len(), 128);
        assert!(!is_package(b"another file"));
        assert!(!is_genuine(Path::new("no such file")));
    }
}
