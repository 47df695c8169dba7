//! Compares the diagnoses of rigs of other kinds with their answers: `evidence/README.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::kinds::score::score;

/// Print what each rig hides and what was named. Ends with 0 if every rig has the right names, with 1 if not.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
}

fn main() -> ExitCode {
    match score(&Folders::new(Options::parse().draw)) {
        Ok(report) => {
            print!("{report}");
            ExitCode::from(u8::from(!report.holds()))
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
