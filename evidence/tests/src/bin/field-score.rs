//! Scores the refined plants of a draw of field rigs, or the named effects: `docs/field-benchmark.md`.

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::field::{names, score};
use retarder_tests::blind::format::Folders;
use serde::Serialize;

/// Score the refined plants of a draw of field rigs. Ends with 0 if all gates pass, with 1 if not.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    /// Score the effects that the diagnosis names instead, on rigs with and without hidden effects.
    #[arg(long)]
    names: bool,
    /// Folder of a draw of the same rigs with better sensors (`field-draw --sensor-share`), whose names are compared.
    #[arg(long, requires = "names")]
    better: Vec<PathBuf>,
    /// Also write the tables as JSON to this file.
    #[arg(long)]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    let Options {
        draw,
        names,
        better,
        json,
    } = Options::parse();
    let better: Vec<Folders> = better.into_iter().map(Folders::new).collect();
    let (folders, json) = (Folders::new(draw), json.as_deref());
    let printed = if names {
        names::score(&folders, &better).map(|report| print(&report, report.holds(), json))
    } else {
        score::score(&folders).map(|report| print(&report, report.holds(), json))
    };
    printed.unwrap_or_else(|error| {
        eprintln!("{error}");
        ExitCode::from(2)
    })
}

/// Prints a report, and writes it as JSON if requested.
fn print(report: &(impl Display + Serialize), holds: bool, json: Option<&Path>) -> ExitCode {
    print!("{report}");
    if let Some(path) = json {
        let text = serde_json::to_string_pretty(report).expect("a report is plain data");
        if let Err(error) = std::fs::write(path, text) {
            eprintln!("{}: {error}", path.display());
            return ExitCode::from(2);
        }
    }
    ExitCode::from(u8::from(!holds))
}
