//! Paths of the workspace, and the cargo that runs this program.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use std::{env, fs, io};

use crate::failure::Failure;
use crate::process;

/// Returns the folder of the workspace's `Cargo.toml`.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// Returns cargo's target folder for the host.
pub(crate) fn target_dir() -> PathBuf {
    let folder = env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    root().join(folder)
}

/// Returns the target folder of the ARM image: a separate one, so that neither build waits for the other's lock or
/// discards its results.
pub(crate) fn arm_target_dir() -> PathBuf {
    target_dir().join("arm")
}

/// Returns a number of the commit, which selects the part of a long check: the same commit always selects the same part.
pub(crate) fn commit_number() -> Result<u32, Failure> {
    let mut head = Command::new("git");
    head.args(["rev-parse", "--short=7", "HEAD"])
        .current_dir(root());
    let said = process::capture(&mut head, Duration::from_secs(10))?;
    // Without a commit, as in an unpacked archive, the part does not matter.
    Ok(u32::from_str_radix(said.trim(), 16).unwrap_or(0))
}

/// Seed of the property tests, so that tests, coverage and mutants of the same tree have the same result. Runs without this
/// program draw new cases.
const PROPERTY_SEED: &str = "1";

/// Creates a command of the cargo that runs this program, in the workspace's folder.
pub(crate) fn cargo() -> Command {
    let program = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut cargo = Command::new(program);
    cargo.current_dir(root());
    cargo.env("PROPTEST_RNG_SEED", PROPERTY_SEED);
    cargo
}

/// Returns the first program of this name on the search path.
pub(crate) fn find_program(name: &str) -> Option<PathBuf> {
    let folders = env::var_os("PATH")?;
    env::split_paths(&folders)
        .map(|folder| folder.join(name))
        .find(|path| path.is_file())
}

/// Returns the contents of a folder, sorted by name.
pub(crate) fn entries(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let list = || {
        let paths = fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path()));
        let mut paths = paths.collect::<io::Result<Vec<_>>>()?;
        paths.sort();
        Ok(paths)
    };
    list().map_err(|source| Failure::File {
        path: folder.to_owned(),
        source,
    })
}
