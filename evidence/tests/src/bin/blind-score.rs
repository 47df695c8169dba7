//! Scores the diagnoses of the rigs of a draw: `docs/blind-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::score::score;

/// Score the diagnoses of the rigs of a draw. Ends with 0 if all requirements are met, with 1 if not.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    /// Also write the tables as JSON to this file.
    #[arg(long)]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let report = match score(&Folders::new(options.draw)) {
        Ok(report) => report,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    print!("{report}");
    if let Some(path) = options.json {
        let text = serde_json::to_string_pretty(&report).expect("a report is plain data");
        if let Err(error) = std::fs::write(&path, text) {
            eprintln!("{}: {error}", path.display());
            return ExitCode::from(2);
        }
    }
    ExitCode::from(u8::from(!report.holds()))
}
