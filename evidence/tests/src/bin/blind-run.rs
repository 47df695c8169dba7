//! Diagnoses the rigs of a draw with the released command: `docs/blind-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::ended;
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::run::{Progress, Released, run};

/// Diagnose the rigs of a draw with the released command; resumes an interrupted run.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    #[command(flatten)]
    released: Released,
    /// Number of parallel diagnoses; each uses as many threads as it needs.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let progress = |Progress { done, all, left }| {
        eprint!("\r{done} of {all} rigs, {} s left   ", left.as_secs());
    };
    let folders = Folders::new(options.draw);
    let done = run(&folders, &options.released, options.jobs, progress);
    ended(done.map(|failed| {
        if failed == 0 {
            return ExitCode::SUCCESS;
        }
        let found = folders.found();
        eprintln!(
            "\n{failed} rigs have no finding; {}/*.failed say why",
            found.path().display()
        );
        ExitCode::FAILURE
    }))
}
