//! Fits the pairs of a draw with each of their effects alone: `docs/blind-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::pairs::run;
use retarder_tests::blind::run::Diagnose;

/// Fits the pairs of a draw with each of their effects alone, to see whether the other one shows; goes on where it was stopped.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    /// The command `retarder`.
    #[arg(long)]
    retarder: PathBuf,
    /// The datasheet's plant.
    #[arg(long, default_value = "data/nominal-plant.toml")]
    plant: PathBuf,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let command = Diagnose {
        retarder: options.retarder,
        plant: options.plant,
    };
    let progress = |done, all| eprint!("\r{done} of {all} fits   ");
    let ended = run(&Folders::new(options.draw), &command, progress);
    eprintln!();
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
