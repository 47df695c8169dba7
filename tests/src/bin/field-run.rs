//! Refines the first plant files of a draw of field rigs by the released command: `docs/field-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::field::run::{Progress, Retarder, run};
use retarder_tests::blind::format::Folders;

/// Refines the first plant file of each rig by the released command; continues where it was stopped.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    #[command(flatten)]
    retarder: Retarder,
    /// Refinements at a time; each uses the threads that it likes.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let progress = |Progress { done, all, left }| {
        eprint!("\r{done} of {all} rigs, {} s left   ", left.as_secs());
    };
    let folders = Folders::new(options.draw);
    match run(&folders, &options.retarder, options.jobs, progress) {
        Ok(0) => {
            eprintln!();
            ExitCode::SUCCESS
        }
        Ok(failed) => {
            let found = folders.found();
            eprintln!(
                "\n{failed} rigs have no finding; {}/*.failed say why",
                found.display()
            );
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("\n{error}");
            ExitCode::from(2)
        }
    }
}
