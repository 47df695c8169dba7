//! `retarder`: commands for model-based control of two on/off solenoid valves.
//!
//! Arguments are parsed ([`cli`]) and their files are checked ([`files`]). They become a task with all files read
//! ([`task`], [`input`]). The task becomes an outcome ([`run`]), which is written and printed ([`output`],
//! [`print`](mod@print), [`page`] with [`report`]).

mod cli;
mod datasheet_dialogue;
mod dut;
mod exchanged;
mod failure;
mod files;
mod input;
mod interrupt;
mod options;
mod output;
mod page;
mod print;
mod progress;
mod run;
mod shell;
mod targets;
mod task;

use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _};

use cli::Cli;
use files::Files;

fn main() -> ExitCode {
    interrupt::set_end(output::exit);
    let matches = match Cli::command().try_get_matches() {
        Ok(matches) => matches,
        Err(error) => match exchanged::explained(&error) {
            Some(failure) => return output::exit_code(Err(failure)),
            None => error.exit(),
        },
    };
    let arguments = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let files = Files::of(&Cli::command(), &matches, arguments.existing());
    let ended = task::Task::resolve(arguments, &files)
        .and_then(task::Task::run)
        .and_then(output::deliver);
    output::exit_code(ended)
}
