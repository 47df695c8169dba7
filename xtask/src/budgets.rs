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
mod figures;
mod gates;
mod instruction;
mod longest_path;
mod panic_free;
mod reach;
mod stack_bound;
mod table;
mod unbounded;

use std::path::PathBuf;

use crate::failure::Failure;
use crate::qemu;
use crate::report::Report;
use crate::toolchain::{Choice, Toolchain};

const TOOLCHAIN: &str = "ARM toolchain";
const QEMU: &str = "QEMU";
const DISASSEMBLER: &str = "disassembler for ARM";
const BENCH: &str = "bench image";
const FIGURES: &str = "sample counted and proved";

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

/// Counts, proves, prints and judges.
pub(crate) fn run(report: &mut Report, choice: Choice) {
    let toolchain = report.step(TOOLCHAIN, || Toolchain::ready(choice));
    let qemu = report.step(QEMU, qemu::ready);
    let disassembler = report.step(DISASSEMBLER, code::ready);
    let compiler = report.step("C compiler for ARM", bench::compiler_ready);
    let features: &[&str] = match compiler {
        Some(()) => &["c-baselines"],
        None => &[],
    };
    let image = report.step(BENCH, || {
        bench::build(needed(&toolchain, TOOLCHAIN)?, "budgets", features)
    });
    let figures = report.step(FIGURES, || {
        needed(&qemu, QEMU)?;
        needed(&disassembler, DISASSEMBLER)?;
        let figures = bench::measure(needed(&image, BENCH)?)?;
        println!(
            "\n{}\n{}\n",
            bench::table(&figures),
            bench::legend(&figures)
        );
        Ok(figures)
    });
    report.step("budgets of a sample", || {
        let gates = gates::gates(needed(&figures, FIGURES)?);
        println!("{}", gates::table(&gates));
        let exceeded = gates::exceeded(&gates);
        if exceeded.is_empty() {
            Ok(())
        } else {
            Err(Unproved::Exceeded(exceeded).into())
        }
    });
    report.step("controller cannot panic", || {
        let toolchain = needed(&toolchain, TOOLCHAIN)?;
        panic_free::links(&mut bench::build_command(toolchain, "panic_free", features))
    });
    report.step("a panic on purpose is found", || {
        let toolchain = needed(&toolchain, TOOLCHAIN)?;
        let features = [features, &["panic-canary"]].concat();
        panic_free::canary_is_refused(&mut bench::build_command(
            toolchain,
            "panic_free",
            &features,
        ))
    });
}

/// The result of an earlier step, or the reason why this one cannot run.
fn needed<'a, T>(result: &'a Option<T>, step: &'static str) -> Result<&'a T, Failure> {
    result.as_ref().ok_or(Failure::Needs(step))
}
