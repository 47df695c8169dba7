//! Computes the errors of the true parameters of a draw of field rigs with the released command:
//! `docs/field-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::ended;
use retarder_tests::blind::field::run::Retarder;
use retarder_tests::blind::field::truth::run;
use retarder_tests::blind::format::Folders;

/// Compute the errors of the true parameters of each rig with the released command; resumes an interrupted run. Reads
/// the answers.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    #[command(flatten)]
    retarder: Retarder,
    /// Number of parallel commands.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let progress = |done, all| eprint!("\r{done} of {all} rigs   ");
    let folders = Folders::new(options.draw);
    let done = run(&folders, &options.retarder, options.jobs, progress);
    ended(done.map(|()| ExitCode::SUCCESS))
}
