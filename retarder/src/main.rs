//! `retarder`: commands for model-based control of two on/off solenoid valves.
//!
//! Arguments are parsed ([`cli`]), become a task with every file read ([`task`], [`input`]), the task becomes an
//! outcome ([`run`]), and the outcome is written and printed ([`output`], [`print`](mod@print), [`page`] with [`report`]). `retarder --help` says the rest.

mod cli;
mod dut;
mod failure;
mod input;
mod interrupt;
mod output;
mod page;
mod print;
mod progress;
mod run;
mod targets;
mod task;

use std::process::ExitCode;

use clap::Parser as _;

fn main() -> ExitCode {
    let arguments = cli::Cli::parse();
    let ended = task::Task::resolve(arguments)
        .and_then(task::Task::run)
        .and_then(output::deliver);
    output::exit_code(ended)
}
