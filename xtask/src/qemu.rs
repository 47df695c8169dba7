//! Emulated machine: a Cortex-M4F in QEMU that runs the same image as a real one.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use clap::ValueEnum;

use crate::failure::Failure;
use crate::workspace::find_program;
use crate::{packages, process};

const PROGRAM: &str = "qemu-system-arm";

/// Timeout of one emulated run. The self-test takes a few seconds; a silent or endless image is stopped after this
/// time.
pub(crate) const DEADLINE: Duration = Duration::from_secs(180);

/// Board that the image can be built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Board {
    /// Arm MPS2 with the AN386 image, emulated by QEMU.
    #[value(name = "mps2-an386")]
    Mps2An386,
    /// ST NUCLEO-G474RE, a real board.
    #[value(name = "nucleo-g474re")]
    NucleoG474Re,
}

impl Board {
    /// Returns the feature of the package `firmware` that selects the board.
    pub(crate) const fn feature(self) -> &'static str {
        match self {
            Self::Mps2An386 => "board-mps2-an386",
            Self::NucleoG474Re => "board-nucleo-g474re",
        }
    }
}

/// Installs QEMU if it is missing.
pub(crate) fn ready() -> Result<(), Failure> {
    match find_program(PROGRAM) {
        Some(_) => Ok(()),
        None => packages::install("QEMU for ARM", &[PROGRAM]),
    }
}

/// Runs an image until it ends with success, and returns its output.
pub(crate) fn run(image: &Path) -> Result<String, Failure> {
    process::capture(&mut command(image), DEADLINE)
}

/// Request for the self-test: the word that the image reads after a reset (`firmware/src/boards/mps2_an386/pins.rs`).
const SELF_TEST_REQUEST: &str = "loader,addr=0x21001040,data=0x74657374,data-len=4";

/// Creates the command of the machine, without window, monitor and serial line: the self-test prints and ends by
/// semihosting.
fn command(image: &Path) -> Command {
    let mut qemu = Command::new(PROGRAM);
    qemu.args(["-machine", "mps2-an386", "-cpu", "cortex-m4"]);
    qemu.args(["-nographic", "-monitor", "none", "-serial", "none"]);
    qemu.args(["-semihosting-config", "enable=on,target=native"]);
    qemu.args(["-device", SELF_TEST_REQUEST])
        .arg("-kernel")
        .arg(image);
    qemu
}
