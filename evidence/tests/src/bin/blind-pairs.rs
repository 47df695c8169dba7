//! Fits the pairs of a draw with each of their effects alone: `docs/blind-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::ended;
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::pairs::run;
use retarder_tests::blind::run::Released;

/// Fit the pairs of a draw with each of their effects alone, to see whether the other one can be detected; resumes an
/// interrupted run.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    #[command(flatten)]
    released: Released,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let progress = |done, all| eprint!("\r{done} of {all} fits   ");
    let done = run(&Folders::new(options.draw), &options.released, progress);
    ended(done.map(|()| ExitCode::SUCCESS))
}
