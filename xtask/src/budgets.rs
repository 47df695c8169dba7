//! What a control sample costs on a Cortex-M4F, and that it costs no more than its budget.
//!
//! Two ways meet. The bench (`budgets/`) counts the instructions of every call over a long trace, exactly and beside its
//! peers ([`bench`], [`counted`]). The linked code itself is read for what holds for any input: the longest path
//! ([`longest_path`]), the deepest stack ([`stack_bound`]), and all that a call can reach ([`reach`]). [`gates`] holds both
//! against the budgets.

mod bench;
mod candidate;
mod code;
mod counted;
mod elf;
mod figures;
mod findings;
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

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::failure::Failure;
use crate::report::Report;
use crate::toolchain::{Choice, TARGET, Toolchain};
use crate::workspace::arm_target_dir;
use crate::{process, qemu};
use code::Code;
use elf::Elf;
use findings::Findings;

/// Longest wait for one build.
const BUILD_DEADLINE: Duration = Duration::from_secs(900);

const TOOLCHAIN: &str = "ARM toolchain";
const QEMU: &str = "QEMU";
const DISASSEMBLER: &str = "disassembler for ARM";
const BENCH: &str = "bench image";
const FIGURES: &str = "sample counted and proved";
const IMAGE: &str = "ARM image";
const STACK: &str = "stack of the image, proved";

/// Why a budget is not proved to be kept.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unproved {
    #[error("{} is no ELF that can be read: {source}", .path.display())]
    Elf {
        path: PathBuf,
        source: object::Error,
    },
    #[error("the bench's output: {0}")]
    Bench(counted::Unreadable),
    #[error("the bench measured `{name}`, which xtask/src/budgets/candidate.rs does not list")]
    Candidate { name: String },
    #[error("over budget:{}", listed(.0))]
    Exceeded(Vec<String>),
    #[error("{} has no `{name}`", .path.display())]
    NoSymbol { path: PathBuf, name: &'static str },
    #[error("the stack of the image has no bound: {0}")]
    Stack(unbounded::Unbounded),
    #[error("panics are left in the image:{}", listed(.0))]
    PanicsLeft(Vec<String>),
    #[error("the self-test did not say how much of its stack it used")]
    NotPainted,
    #[error(
        "a panic is left in an image that must not have one; the linker says who calls it:\n{said}"
    )]
    CanPanic { said: String },
    #[error("an image with a panic on purpose linked: the proof by the linker proves nothing")]
    CanaryLinked,
}

fn listed(lines: &[String]) -> String {
    lines.iter().map(|line| format!("\n    {line}")).collect()
}

/// Counts, proves, prints and judges; `json` is where the findings go besides.
pub(crate) fn run(report: &mut Report, choice: Choice, json: Option<&Path>) {
    let toolchain = report.step(TOOLCHAIN, || Toolchain::ready(choice));
    let qemu = report.step(QEMU, qemu::ready);
    let disassembler = report.step(DISASSEMBLER, code::ready);
    let tools = Tools {
        toolchain,
        qemu,
        disassembler,
    };
    let mut findings = Findings::default();
    sample(report, &tools, &mut findings);
    image(report, &tools, &mut findings);
    if let Some(path) = json {
        report.step("findings written", || findings.write(path));
    }
}

/// What the steps need, each if it is there.
struct Tools {
    toolchain: Option<Toolchain>,
    qemu: Option<()>,
    disassembler: Option<()>,
}

impl Tools {
    /// A cargo command that builds a package for the ECU.
    fn build(&self, arguments: &[&str]) -> Result<Command, Failure> {
        let mut build = needed(&self.toolchain, TOOLCHAIN)?.cargo("build");
        build.args(arguments);
        Ok(build)
    }
}

/// One sample of the controller, beside its peers.
fn sample(report: &mut Report, tools: &Tools, findings: &mut Findings) {
    // Without the compiler the table has no rows in C, and the budgets that compare with them fail.
    let compiler = report.step("C compiler for ARM", bench::compiler_ready);
    let baselines = compiler.map_or("", |()| "c-baselines");
    let bench = report.step(BENCH, || {
        let arguments = ["--package", "budgets", "--bin", "budgets", "--features"];
        let mut build = tools.build(&[&arguments, [baselines].as_slice()].concat())?;
        process::run(&mut build, BUILD_DEADLINE)?;
        Ok(built("budgets"))
    });
    let figures = report.step(FIGURES, || {
        needed(&tools.qemu, QEMU)?;
        needed(&tools.disassembler, DISASSEMBLER)?;
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
        println!("{}", gates::table(&gates));
        findings.judge(&gates)
    });
    let arguments = ["--package", "budgets", "--bin", "panic_free"];
    report.step("controller cannot panic", || {
        panic_free::links(&mut tools.build(&arguments)?)
    });
    report.step("a panic on purpose is found", || {
        let canary = [arguments.as_slice(), &["--features", "panic-canary"]].concat();
        panic_free::canary_is_refused(&mut tools.build(&canary)?)
    });
}

/// The image that is flashed.
fn image(report: &mut Report, tools: &Tools, findings: &mut Findings) {
    let arguments = ["--package", "firmware"];
    report.step("image cannot panic", || {
        let proof = [arguments.as_slice(), &["--features", "prove-panic-free"]].concat();
        panic_free::links(&mut tools.build(&proof)?)
    });
    report.step("image with a panic on purpose is refused", || {
        let canary = [arguments.as_slice(), &["--features", "panic-canary"]].concat();
        panic_free::canary_is_refused(&mut tools.build(&canary)?)
    });
    // Last, so that this one is what lies in the folder afterwards.
    let image = report.step(IMAGE, || {
        process::run(&mut tools.build(&arguments)?, BUILD_DEADLINE)?;
        needed(&tools.disassembler, DISASSEMBLER)?;
        let elf = Elf::read(&built("firmware"))?;
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
        findings.judge(&[stack.gate()])?;
        Ok(stack)
    });
    report.step("stack of the image, painted", || {
        needed(&tools.qemu, QEMU)?;
        let (elf, _) = needed(&image, IMAGE)?;
        let used = image::painted(&qemu::run(elf.path())?)?;
        let gates = [needed(&stack, STACK)?.painted(used)];
        println!("{}", gates::table(&gates));
        findings.judge(&gates)
    });
    report.step("flash and RAM of the image", || {
        let (elf, _) = needed(&image, IMAGE)?;
        let sizes = sizes::sizes(elf)?;
        println!("{}", sizes::table(&sizes));
        findings.judge(&sizes::gates(&sizes))
    });
}

/// Where a program for the ECU lies once it is built.
fn built(program: &str) -> PathBuf {
    arm_target_dir().join(TARGET).join("firmware").join(program)
}

/// The result of an earlier step, or the reason why this one cannot run.
fn needed<'a, T>(result: &'a Option<T>, step: &'static str) -> Result<&'a T, Failure> {
    result.as_ref().ok_or(Failure::Needs(step))
}
