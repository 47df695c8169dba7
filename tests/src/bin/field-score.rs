//! Scores the refined plants of a draw of field rigs: `docs/field-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::field::score::score;
use retarder_tests::blind::format::Folders;

/// Scores the refined plants of a draw of field rigs. Ends with 0 if all gates pass, with 1 if not.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    /// Write the tables to this file as JSON, too.
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
