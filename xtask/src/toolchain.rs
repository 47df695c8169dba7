//! Where the ARM target comes from: rustup's ready library, or Debian's toolchain, which builds `core` from its sources.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use clap::ValueEnum;

use crate::failure::Failure;
use crate::workspace::{arm_target_dir, cargo, find_program};
use crate::{packages, process};

/// The processor of the ECU: a Cortex-M4F, hardware floating point for whoever else runs there.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";

/// Longest wait for rustup's download.
const RUSTUP_DEADLINE: Duration = Duration::from_secs(300);
/// Longest wait for an answer about what is installed.
const ASK_DEADLINE: Duration = Duration::from_secs(30);

/// Debian's toolchain for the web browsers it builds: newer than its `rustc`, and with the library's sources.
const DEBIAN_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CARGO: &str = "/usr/bin/cargo";

/// Which toolchain a person wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// The toolchain in use if it has the target or rustup can fetch it, else Debian's.
    Auto,
    /// The toolchain in use, its target fetched by rustup.
    Rustup,
    /// Debian's packages, `core` built from source.
    Debian,
}

/// A toolchain that can build for the ECU.
pub(crate) enum Toolchain {
    /// The one in use; the target's library is installed beside it.
    InUse,
    /// Debian's, with the linker found for it.
    Debian { linker: PathBuf },
}

impl Toolchain {
    /// Finds the toolchain, and installs what is missing of it.
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

    /// A cargo command for the ECU, such as `build`, with everything that the toolchain needs said.
    pub(crate) fn cargo(&self, verb: &str) -> Command {
        self.cargo_into(verb, &arm_target_dir())
    }

    /// The same with another target folder.
    pub(crate) fn cargo_into(&self, verb: &str, target_dir: &Path) -> Command {
        let mut cargo = cargo();
        if let Self::Debian { linker } = self {
            let folder = cargo.get_current_dir().map(Path::to_owned);
            cargo = Command::new(DEBIAN_CARGO);
            cargo.current_dir(folder.unwrap_or_default());
            cargo.env("RUSTC", DEBIAN_RUSTC);
            // What the outer cargo said about its own toolchain does not hold for this one.
            for stale in ["CARGO", "RUSTDOC", "RUSTUP_TOOLCHAIN", "RUSTC_WRAPPER"] {
                cargo.env_remove(stale);
            }
            // Building `core` is an unstable wish, which a stable compiler grants only when told so.
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

    /// Whether it brings clippy.
    pub(crate) fn has_clippy(&self) -> bool {
        matches!(self, Self::InUse)
    }
}

/// The toolchain in use, with the target's library fetched by rustup if it is not there.
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

/// Debian's toolchain, with its packages installed by apt if they are not there.
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

/// A linker for ARM: rustup's toolchains bring one, Debian's binutils are another.
fn linker() -> Result<PathBuf, Failure> {
    const GNU: &str = "arm-none-eabi-ld";
    if let Some(lld) = rustup_lld().or_else(|| find_program(GNU)) {
        return Ok(lld);
    }
    packages::install("a linker for ARM", &["binutils-arm-none-eabi"])?;
    Ok(PathBuf::from(GNU))
}

/// The linker that lies beside the compiler in use.
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
