//! Refines the first plant files of a draw of field rigs with the released command, and diagnoses missing effects:
//! `docs/field-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::ended;
use retarder_tests::blind::field::run::{Progress, Retarder, diagnose, fit, refine};
use retarder_tests::blind::format::{Folders, Stage};
use retarder_tests::blind::run::RunError;

/// Refine the first plant file of each rig with the released command; resumes an interrupted run.
#[derive(Parser)]
struct Options {
    /// Folder of the draw.
    #[arg(long)]
    draw: PathBuf,
    #[command(flatten)]
    retarder: Retarder,
    /// Number of parallel commands; each uses as many threads as it needs.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
    /// Also diagnose each rig with its refined plant, and fit the named effects.
    #[arg(long)]
    names: bool,
}

fn main() -> ExitCode {
    ended(run(&Options::parse()).map(|missing| ExitCode::from(u8::from(missing > 0))))
}

/// Runs the stages one after the other. Returns the number of missing findings.
fn run(options: &Options) -> Result<usize, RunError> {
    let (folders, retarder, jobs) = (
        &Folders::new(&options.draw),
        &options.retarder,
        options.jobs,
    );
    let mut missing = print_missing(
        &folders.found(),
        refine(folders, retarder, jobs, progress("refined"))?,
    );
    if options.names {
        missing += print_missing(
            &folders.named(),
            diagnose(folders, retarder, jobs, progress("diagnosed"))?,
        );
        missing += print_missing(
            &folders.fitted(),
            fit(folders, retarder, jobs, progress("fitted"))?,
        );
    }
    Ok(missing)
}

fn progress(done_what: &str) -> impl Fn(Progress) + Sync {
    move |Progress { done, all, left }| {
        eprint!(
            "\r{done} of {all} rigs {done_what}, {} s left   ",
            left.as_secs()
        );
    }
}

/// Ends the line of progress, and prints the folder with the reasons of missing findings.
fn print_missing(stage: &Stage, missing: usize) -> usize {
    eprintln!();
    if missing > 0 {
        let folder = stage.path().display();
        eprintln!("{missing} rigs have no finding; {folder}/*.failed say why");
    }
    missing
}
