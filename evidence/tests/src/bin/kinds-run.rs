//! Diagnoses the rigs of other kinds of a draw with the released command: `evidence/README.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::ended;
use retarder_tests::blind::field::run::{Progress, Retarder};
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::kinds::run::diagnose;

/// Write the plant file of each rig from its plate and diagnose it with the released command; resumes an interrupted
/// run.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    #[command(flatten)]
    retarder: Retarder,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let progress = |Progress { done, all, left }| {
        eprint!("\r{done} of {all} rigs, {} s left   ", left.as_secs());
    };
    let done = diagnose(&Folders::new(options.draw), &options.retarder, progress);
    ended(done.map(|missing| ExitCode::from(u8::from(missing > 0))))
}
