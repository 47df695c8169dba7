//! Bench: run on the emulated machine, and its code analysed for bounds that a run cannot show.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::code::Code;
use super::counted::Counted;
use super::elf::Elf;
use super::figures::Figures;
use super::table::Table;
use super::unbounded::Unbounded;
use super::unproved::Unproved;
use crate::failure::Failure;
use crate::workspace::find_program;
use crate::{packages, process};

const COMPILER: &str = "arm-none-eabi-gcc";
/// Timeout of the bench, which takes some seconds.
const RUN_DEADLINE: Duration = Duration::from_secs(120);

/// Installs the C compiler if it is missing.
pub(crate) fn compiler_ready() -> Result<(), Failure> {
    match find_program(COMPILER) {
        Some(_) => Ok(()),
        None => packages::install("the C compiler for ARM", &["gcc-arm-none-eabi"]),
    }
}

/// Runs the bench and derives bounds from its code.
pub(crate) fn measure(image: &Path) -> Result<Vec<Figures>, Failure> {
    let said = process::capture(&mut counting_machine(image), RUN_DEADLINE)?;
    let code = Code::of(&Elf::read(image)?)?;
    let counted = Counted::read(&said).map_err(Unproved::Bench)?;
    let figures = counted.into_iter().map(|counted| {
        let name = counted.name.clone();
        let figures = Figures::of(&code, counted);
        figures.ok_or_else(|| Unproved::Candidate { name }.into())
    });
    let mut figures = figures.collect::<Result<Vec<_>, Failure>>()?;
    figures.sort_by_key(|figures| figures.candidate.place());
    Ok(figures)
}

/// Creates the command of a machine whose instructions take 1024 ns each, so that its clock counts them
/// (`evidence/budgets/src/counter.rs`).
fn counting_machine(image: &Path) -> Command {
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-machine", "mps2-an386", "-cpu", "cortex-m4"]);
    qemu.args(["-nographic", "-monitor", "none", "-serial", "none"]);
    qemu.args(["-semihosting-config", "enable=on,target=native"]);
    qemu.args(["-icount", "shift=10"]);
    qemu.arg("-kernel").arg(image);
    qemu
}

/// Returns the figures as a table.
pub(crate) fn table(figures: &[Figures]) -> Table {
    let mut table = Table::new(&[
        "instructions per call, bytes",
        "mean",
        "seen",
        "proved",
        "code",
        "state",
        "config",
        "stack",
        "touched",
        "panics",
        "differs %",
    ]);
    let mut duty = None;
    for figures in figures {
        if duty.replace(figures.candidate.duty) != Some(figures.candidate.duty) {
            table.row(vec![figures.candidate.duty.to_string()]);
        }
        table.row(row(figures));
    }
    table
}

fn row(figures: &Figures) -> Vec<String> {
    let counted = &figures.counted;
    let bound = |bound: &Result<u32, Unbounded>| match bound {
        Ok(bound) => bound.to_string(),
        Err(reason) => reason.word().to_owned(),
    };
    let panics = if figures.reach.panics.is_empty() {
        "no"
    } else {
        "yes"
    };
    let deviation = figures.deviation_pct();
    vec![
        format!("  {}", figures.candidate.title),
        format!("{:.1}", counted.mean()),
        counted.max.to_string(),
        bound(&figures.proved),
        figures.reach.bytes.to_string(),
        counted.state_bytes.to_string(),
        counted.config_bytes.to_string(),
        bound(&figures.stack),
        counted.stack.to_string(),
        panics.to_owned(),
        deviation.map_or("-".to_owned(), |deviation| format!("{deviation:.4}")),
    ]
}

/// Returns the meaning of the columns, and the reasons for missing bounds.
pub(crate) fn legend(figures: &[Figures]) -> String {
    let mut legend = LEGEND.to_owned();
    for figures in figures {
        if let Err(reason) = &figures.proved {
            legend += &format!("\nno bound: {}\n    {reason}", figures.candidate.title);
        }
    }
    legend
}

const LEGEND: &str = "\
mean, seen: over 102 400 samples of one closed loop, the same for all but ecu::Ecu, which drives its own plant
    (evidence/budgets/src/trace.rs); the return counts, the call does not
proved: longest path through the linked code, callees included, for any input; code with a loop has none
code: of the function and all it reaches, constants between the code included, the panic handler not
stack: bound from the linked code; touched: what the run wrote
state: ecu::Ecu keeps two copies of its configuration in it
panics: whether a path leads to the panic handler; Rust is compiled as the image is, with overflow checks on
differs: a duty cycle from the controller's, at most";
