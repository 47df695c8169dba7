//! Cost of a control sample on a Cortex-M4F, and its budgets.
//!
//! There are two methods. The bench (`evidence/budgets/`) counts the instructions of every call over a long trace, for our code
//! and for comparable controllers ([`mod@bench`], [`counted`]). The analysis of the linked code gives bounds for any
//! input: the longest path ([`longest_path`]), the deepest stack ([`stack_bound`]), and all code that a call can reach
//! ([`reach`]). [`gates`] compares both with the budgets.

mod bench;
mod call_search;
mod candidate;
mod code;
mod counted;
mod elf;
mod figures;
mod findings;
mod gate;
mod gates;
mod image;
mod instruction;
mod longest_path;
mod panic_free;
mod reach;
mod sizes;
mod stack_bound;
mod table;
mod unbounded;
pub(crate) mod unproved;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::arm;
use crate::failure::Failure;
use crate::process;
use crate::qemu::{self, Board};
use crate::report::Report;
use crate::toolchain::{Choice, TARGET, Toolchain};
use crate::workspace::arm_target_dir;
use code::Code;
use elf::Elf;
use findings::Findings;

/// Timeout of one build.
const BUILD_DEADLINE: Duration = Duration::from_secs(900);

const TOOLS: &str = "toolchain, emulator and disassembler for ARM";
const COMPILER: &str = "C compiler for ARM";
const DISASSEMBLER: &str = "disassembler for ARM";
const BENCH: &str = "bench image";
const FIGURES: &str = "sample counted and proved";
const IMAGE: &str = "ARM image";
const STACK: &str = "stack of the image, proved";

/// Installs the requirements of this command beyond the image's toolchain and the emulator.
pub(crate) fn setup(report: &mut Report) {
    report.step(DISASSEMBLER, code::ready);
    report.step(COMPILER, bench::compiler_ready);
}

/// Counts instructions, derives bounds, prints them and compares them with the budgets; `json` is the file for the
/// findings, if given.
pub(crate) fn run(report: &mut Report, choice: Choice, json: Option<&Path>) {
    let toolchain = report.step(TOOLS, || {
        qemu::ready()?;
        code::ready()?;
        Toolchain::ready(choice)
    });
    let mut findings = Findings::default();
    sample(report, toolchain.as_ref(), &mut findings);
    image_of_nucleo(report, toolchain.as_ref(), &mut findings);
    image(report, toolchain.as_ref(), &mut findings);
    if let Some(path) = json {
        report.step("findings written", || findings.write(path));
    }
}

/// Measures one sample of the controller and of comparable controllers.
fn sample(report: &mut Report, toolchain: Option<&Toolchain>, findings: &mut Findings) {
    // Without the compiler the table has no rows in C, and the budgets that compare with them fail.
    let compiler = report.step(COMPILER, bench::compiler_ready);
    let baselines = compiler.map_or("", |()| "c-baselines");
    let build = |program: &str, features: &str| {
        let mut build = needed(&toolchain, TOOLS)?.cargo("build");
        build.args(["--package", "budgets", "--bin", program]);
        build.args(["--features", features]);
        Ok::<_, Failure>(build)
    };
    let bench = report.step(BENCH, || {
        process::run(&mut build("budgets", baselines)?, BUILD_DEADLINE)?;
        Ok(built("budgets"))
    });
    let figures = report.step(FIGURES, || {
        let figures = bench::measure(needed(&bench, BENCH)?)?;
        println!(
            "\n{}\n{}\n",
            bench::table(&figures),
            bench::legend(&figures)
        );
        findings.measured(&figures);
        Ok(figures)
    });
    report.step("budgets of a sample", || {
        let gates = gates::gates(needed(&figures, FIGURES)?);
        println!("{}", gate::table(&gates));
        findings.judge(&gates)
    });
    report.step("controller cannot panic", || {
        panic_free::links(&mut build("panic_free", "")?)
    });
    report.step("a panic on purpose is found", || {
        panic_free::canary_is_refused(&mut build("panic_free", "panic-canary")?)
    });
}

/// Checks the image of the real board: it cannot panic, and its stack is bounded.
fn image_of_nucleo(report: &mut Report, toolchain: Option<&Toolchain>, findings: &mut Findings) {
    let build = |feature: &str| image_build(toolchain, Board::NucleoG474Re, feature);
    report.step("image of the NUCLEO-G474RE cannot panic", || {
        panic_free::links(&mut build("prove-panic-free")?)
    });
    report.step("the same with a panic on purpose is refused", || {
        panic_free::canary_is_refused(&mut build("panic-canary")?)
    });
    report.step("stack of the image of the NUCLEO-G474RE, proved", || {
        process::run(&mut build("")?, BUILD_DEADLINE)?;
        let elf = Elf::read(&arm::image_of(Board::NucleoG474Re))?;
        let stack = image::Stack::of(&elf, &Code::of(&elf)?)?;
        println!("{}", stack.table());
        findings.judge(&[stack.gate("image of the NUCLEO-G474RE")])
    });
}

/// Checks the image of the emulated board in the same way, and its painted stack and its size.
fn image(report: &mut Report, toolchain: Option<&Toolchain>, findings: &mut Findings) {
    let build = |feature: &str| image_build(toolchain, Board::Mps2An386, feature);
    report.step("image cannot panic", || {
        panic_free::links(&mut build("prove-panic-free")?)
    });
    report.step("image with a panic on purpose is refused", || {
        panic_free::canary_is_refused(&mut build("panic-canary")?)
    });
    // Last, so that this image is the one in the folder afterwards.
    let image = report.step(IMAGE, || {
        process::run(&mut build("")?, BUILD_DEADLINE)?;
        let elf = Elf::read(&arm::image_of(Board::Mps2An386))?;
        let code = Code::of(&elf)?;
        Ok((elf, code))
    });
    report.step("no panic left in the image", || {
        let (_, code) = needed(&image, IMAGE)?;
        Ok(image::has_no_panic(code)?)
    });
    let stack = report.step(STACK, || {
        let (elf, code) = needed(&image, IMAGE)?;
        let stack = image::Stack::of(elf, code)?;
        println!("{}", stack.table());
        findings.judge(&[stack.gate("image")])?;
        Ok(stack)
    });
    report.step("stack of the image, painted", || {
        let (elf, _) = needed(&image, IMAGE)?;
        let used = image::painted(&qemu::run(elf.path())?)?;
        let gates = [needed(&stack, STACK)?.painted(used)];
        println!("{}", gate::table(&gates));
        findings.judge(&gates)
    });
    report.step("flash and RAM of the image", || {
        let (elf, _) = needed(&image, IMAGE)?;
        let sizes = sizes::sizes(elf)?;
        println!("{}", sizes::table(&sizes));
        findings.judge(&sizes::gates(&sizes))
    });
}

/// Creates the command that builds the image of a board with this feature.
fn image_build(
    toolchain: Option<&Toolchain>,
    board: Board,
    feature: &str,
) -> Result<Command, Failure> {
    let mut build = arm::for_board(needed(&toolchain, TOOLS)?, "build", board);
    build.args(["--features", feature]);
    Ok(build)
}

/// Returns the path of a program for the ECU.
fn built(program: &str) -> PathBuf {
    arm_target_dir().join(TARGET).join("firmware").join(program)
}

/// Returns the result of an earlier step, or the failure that this step cannot run.
fn needed<'a, T>(result: &'a Option<T>, step: &'static str) -> Result<&'a T, Failure> {
    result.as_ref().ok_or(Failure::Needs(step))
}
