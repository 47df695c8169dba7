//! Judges the true parameters of a draw of field rigs by the released command: `docs/field-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::field::run::Retarder;
use retarder_tests::blind::field::truth::run;
use retarder_tests::blind::format::Folders;

/// Judges the true parameters of each rig by the released command; continues where it was stopped. Opens the answers.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    #[command(flatten)]
    retarder: Retarder,
    /// Judgements at a time.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let progress = |done, all| eprint!("\r{done} of {all} rigs   ");
    let folders = Folders::new(options.draw);
    let ended = run(&folders, &options.retarder, options.jobs, progress);
    eprintln!();
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
