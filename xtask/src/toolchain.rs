//! Sources of the ARM target: rustup's compiled library, or Debian's toolchain, which builds `core` from its sources.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use clap::ValueEnum;

use crate::failure::Failure;
use crate::workspace::{arm_target_dir, cargo, find_program};
use crate::{packages, process};

/// Target of the ECU: a Cortex-M4F with hardware floating point, which only code other than the controller uses.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";

/// Timeout of rustup's download.
const RUSTUP_DEADLINE: Duration = Duration::from_secs(300);
/// Timeout of a query about installed parts.
const ASK_DEADLINE: Duration = Duration::from_secs(30);

/// Debian's toolchain for its web browsers: newer than its `rustc`, and with the library's sources.
const DEBIAN_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CARGO: &str = "/usr/bin/cargo";

/// Choice of the toolchain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// The toolchain in use if it has the target or rustup can install it, else Debian's.
    Auto,
    /// The toolchain in use, with its target installed by rustup.
    Rustup,
    /// Debian's packages, `core` built from source.
    Debian,
}

/// Toolchain that can build for the ECU.
pub(crate) enum Toolchain {
    /// The toolchain in use, with the target's library installed.
    InUse,
    /// Debian's toolchain, with a linker.
    Debian { linker: PathBuf },
}

impl Toolchain {
    /// Finds the toolchain, and installs its missing parts.
    pub(crate) fn ready(choice: Choice) -> Result<Self, Failure> {
        match choice {
            Choice::Rustup => in_use(),
            Choice::Debian => debian(),
            Choice::Auto => in_use().or_else(|failure| {
                eprintln!("{failure}\ntrying Debian's toolchain instead");
                debian()
            }),
        }
    }

    /// Creates a cargo command for the ECU, such as `build`, with all options that the toolchain needs.
    pub(crate) fn cargo(&self, verb: &str) -> Command {
        self.cargo_into(verb, &arm_target_dir())
    }

    /// Creates the same command with another target folder.
    pub(crate) fn cargo_into(&self, verb: &str, target_dir: &Path) -> Command {
        let mut cargo = cargo();
        if let Self::Debian { linker } = self {
            let folder = cargo.get_current_dir().map(Path::to_owned);
            cargo = Command::new(DEBIAN_CARGO);
            cargo.current_dir(folder.unwrap_or_default());
            cargo.env("RUSTC", DEBIAN_RUSTC);
            // These variables of the outer cargo describe its own toolchain and are wrong for this one.
            for stale in ["CARGO", "RUSTDOC", "RUSTUP_TOOLCHAIN", "RUSTC_WRAPPER"] {
                cargo.env_remove(stale);
            }
            // Building `core` is unstable; a stable compiler allows it only with this variable.
            cargo.env("RUSTC_BOOTSTRAP", "1");
            cargo.env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker);
        }
        cargo.arg(verb);
        if let Self::Debian { .. } = self {
            cargo.args(["-Z", "build-std=core"]);
        }
        cargo.args(["--target", TARGET, "--profile", "firmware"]);
        cargo.arg("--target-dir").arg(target_dir);
        cargo
    }

    /// Returns whether the toolchain has clippy.
    pub(crate) fn has_clippy(&self) -> bool {
        matches!(self, Self::InUse)
    }
}

/// Returns the toolchain in use, with the target's library installed by rustup if it is missing.
fn in_use() -> Result<Toolchain, Failure> {
    if target_is_installed()? {
        return Ok(Toolchain::InUse);
    }
    let missing = || Failure::Missing {
        what: format!("the target {TARGET}"),
        paste: format!("rustup target add {TARGET}"),
    };
    if find_program("rustup").is_none() {
        return Err(missing());
    }
    let mut add = Command::new("rustup");
    add.args(["target", "add", TARGET]);
    process::run(&mut add, RUSTUP_DEADLINE).map_err(|failure| {
        eprintln!("{failure}");
        missing()
    })?;
    Ok(Toolchain::InUse)
}

fn target_is_installed() -> Result<bool, Failure> {
    let library = sysroot("rustc")?
        .join("lib/rustlib")
        .join(TARGET)
        .join("lib");
    Ok(library.is_dir())
}

/// Returns Debian's toolchain, with its packages installed by apt if they are missing.
fn debian() -> Result<Toolchain, Failure> {
    let complete = || {
        let sources = sysroot(DEBIAN_RUSTC)?.join("lib/rustlib/src/rust/library/core");
        Ok::<_, Failure>(sources.is_dir() && Path::new(DEBIAN_CARGO).is_file())
    };
    if !complete().unwrap_or(false) {
        packages::install("Debian's Rust toolchain", &DEBIAN_PACKAGES)?;
    }
    Ok(Toolchain::Debian { linker: linker()? })
}

/// Returns a linker for ARM: from rustup's toolchain, or from Debian's binutils.
fn linker() -> Result<PathBuf, Failure> {
    const GNU: &str = "arm-none-eabi-ld";
    if let Some(lld) = rustup_lld().or_else(|| find_program(GNU)) {
        return Ok(lld);
    }
    packages::install("a linker for ARM", &["binutils-arm-none-eabi"])?;
    Ok(PathBuf::from(GNU))
}

/// Returns the linker beside the compiler in use.
fn rustup_lld() -> Option<PathBuf> {
    let libraries = sysroot("rustc").ok()?.join("lib/rustlib");
    let hosts = libraries.read_dir().ok()?;
    hosts
        .filter_map(Result::ok)
        .map(|host| host.path().join("bin/rust-lld"))
        .find(|path| path.is_file())
}

pub(crate) fn sysroot(rustc: &str) -> Result<PathBuf, Failure> {
    let mut ask = Command::new(rustc);
    ask.args(["--print", "sysroot"]);
    let said = process::capture(&mut ask, ASK_DEADLINE)?;
    Ok(PathBuf::from(said.trim_end()))
}
