//! Image for the ECU: built for each board, run on the emulated machine, its bits compared with the host's.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::digests::{Difference, Run};
use crate::failure::Failure;
use crate::qemu::{self, Board};
use crate::report::Report;
use crate::tests::Which;
use crate::toolchain::{Choice, TARGET, Toolchain};
use crate::workspace::{arm_target_dir, cargo, target_dir};
use crate::{process, tests};

const BUILD_DEADLINE: Duration = Duration::from_secs(900);
/// Timeout of the self-test on the host.
const HOST_DEADLINE: Duration = Duration::from_secs(120);

const TOOLCHAIN: &str = "ARM toolchain";
const QEMU: &str = "QEMU";
const IMAGE: &str = "ARM image";
const IMAGE_OF_NUCLEO: &str = "ARM image, NUCLEO-G474RE";
const ON_HOST: &str = "self-test on the host";
const IN_QEMU: &str = "self-test in QEMU";

/// Installs the requirements of the other functions of this file.
pub(crate) fn setup(report: &mut Report, choice: Choice) {
    report.step(TOOLCHAIN, || Toolchain::ready(choice));
    report.step(QEMU, qemu::ready);
}

/// Builds the image and prints its path.
pub(crate) fn image(report: &mut Report, board: Board, choice: Choice) {
    let toolchain = report.step(TOOLCHAIN, || Toolchain::ready(choice));
    if let Some(image) = report.step(IMAGE, || build(needed(&toolchain, TOOLCHAIN)?, board)) {
        println!("{}", image.display());
    }
}

/// Builds the image, runs it, and compares its bits with those of the same code on the host.
pub(crate) fn test(report: &mut Report, choice: Choice) {
    let toolchain = report.step(TOOLCHAIN, || Toolchain::ready(choice));
    let qemu = report.step(QEMU, qemu::ready);
    if toolchain.as_ref().is_some_and(Toolchain::has_clippy) {
        report.step("clippy on the ARM image", || {
            lint(needed(&toolchain, TOOLCHAIN)?, Board::Mps2An386)
        });
        report.step("clippy on the ARM image, NUCLEO-G474RE", || {
            lint(needed(&toolchain, TOOLCHAIN)?, Board::NucleoG474Re)
        });
    }
    report.step(IMAGE_OF_NUCLEO, || {
        build(needed(&toolchain, TOOLCHAIN)?, Board::NucleoG474Re)
    });
    let image = report.step(IMAGE, || {
        build(needed(&toolchain, TOOLCHAIN)?, Board::Mps2An386)
    });
    let host = report.step(ON_HOST, || {
        build_for_host()?;
        run_on_host(None)
    });
    let arm = report.step(IN_QEMU, || {
        needed(&qemu, QEMU)?;
        run_in_qemu(needed(&image, IMAGE)?)
    });
    report.step("host and ARM bits equal", || {
        let (host, arm) = (needed(&host, ON_HOST)?, needed(&arm, IN_QEMU)?);
        Run::compare(host, arm)?;
        let (steps, configurations) = (host.steps(), host.names().len());
        eprintln!("{steps} steps in {configurations} configurations: the same bits");
        Ok(())
    });
    report.step("one flipped bit is found", || {
        canary(needed(&host, ON_HOST)?)
    });
    report.step("image in the loop", || {
        needed(&qemu, QEMU)?;
        tests::run(Which::Image(needed(&image, IMAGE)?))
    });
}

/// Returns the result of an earlier step, or the failure that this step cannot run.
fn needed<'a, T>(result: &'a Option<T>, step: &'static str) -> Result<&'a T, Failure> {
    result.as_ref().ok_or(Failure::Needs(step))
}

/// Runs clippy on the code that only the image contains; the host's clippy does not see it.
fn lint(toolchain: &Toolchain, board: Board) -> Result<(), Failure> {
    let mut clippy = for_board(toolchain, "clippy", board);
    clippy.args(["--", "-D", "warnings"]);
    process::run(&mut clippy, BUILD_DEADLINE)
}

fn build(toolchain: &Toolchain, board: Board) -> Result<PathBuf, Failure> {
    process::run(&mut for_board(toolchain, "build", board), BUILD_DEADLINE)?;
    let image = image_of(board);
    let size = image.metadata().map_err(|source| Failure::File {
        path: image.clone(),
        source,
    })?;
    eprintln!(
        "{} ({} bytes with debug information)",
        image.display(),
        size.len()
    );
    Ok(image)
}

/// Creates a cargo command on the image of a board.
pub(crate) fn for_board(toolchain: &Toolchain, verb: &str, board: Board) -> Command {
    let mut cargo = toolchain.cargo_into(verb, &image_dir(board));
    cargo.args(["--package", "firmware", "--no-default-features"]);
    cargo.args(["--features", board.feature()]);
    cargo
}

/// Returns the path of a board's image.
pub(crate) fn image_of(board: Board) -> PathBuf {
    image_dir(board).join(TARGET).join("firmware/firmware")
}

/// Returns a folder for each board, since the images have the same name.
fn image_dir(board: Board) -> PathBuf {
    match board {
        Board::Mps2An386 => arm_target_dir(),
        Board::NucleoG474Re => arm_target_dir().join("nucleo-g474re"),
    }
}

fn build_for_host() -> Result<(), Failure> {
    process::run(
        cargo().args(["build", "--package", "firmware"]),
        BUILD_DEADLINE,
    )
}

/// Runs the firmware on the host; `canary` names the bit that is flipped on purpose.
fn run_on_host(canary: Option<&str>) -> Result<Run, Failure> {
    let mut firmware = Command::new(target_dir().join("debug/firmware"));
    firmware.env_remove("FIRMWARE_CANARY");
    if let Some(place) = canary {
        firmware.env("FIRMWARE_CANARY", place);
    }
    let said = process::capture(&mut firmware, HOST_DEADLINE)?;
    read("the host", &said)
}

fn run_in_qemu(image: &Path) -> Result<Run, Failure> {
    let said = qemu::run(image)?;
    read("the ARM image", &said)
}

fn read(machine: &'static str, text: &str) -> Result<Run, Failure> {
    Run::read(text).map_err(|source| Failure::Digests { machine, source })
}

/// Tests the comparison: it must fail at the very step whose output has a flipped bit.
fn canary(host: &Run) -> Result<(), Failure> {
    const STEP: u64 = 4711;
    for name in host.names() {
        let planted = format!("{name}:{STEP}");
        let flipped = run_on_host(Some(&planted))?;
        let found = Run::compare(host, &flipped);
        let right = match &found {
            Err(Difference::Bits {
                name: differing,
                from,
                until,
                ..
            }) => *differing == name && (*from..*until).contains(&STEP),
            _ => false,
        };
        if !right {
            let said = found
                .err()
                .map_or("no difference".to_owned(), |difference| {
                    difference.to_string()
                });
            return Err(Failure::CanaryLived { planted, said });
        }
    }
    Ok(())
}
