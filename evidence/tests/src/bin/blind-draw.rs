//! Draws sealed rigs from a seed: `docs/blind-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::draw::{Counts, Draw, DrawError};
use retarder_tests::blind::ended;
use retarder_tests::blind::format::Folders;

/// Draw sealed rigs from a seed.
#[derive(Parser)]
struct Options {
    /// Folder of the draw; `logs` and `sealed` in it must not exist.
    #[arg(long)]
    out: PathBuf,
    /// Seed.
    #[arg(long)]
    seed: u64,
    /// Share of the full set.
    #[arg(long, default_value_t = 1.0)]
    share: f64,
    /// Numbers of rigs; without this option all of them.
    #[arg(long)]
    rig: Vec<usize>,
    /// Number of threads.
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

fn main() -> ExitCode {
    ended(draw(Options::parse()).map(|()| ExitCode::SUCCESS))
}

fn draw(options: Options) -> Result<(), DrawError> {
    let mut draw = Draw::new(options.seed, Counts::FULL.share(options.share));
    if !options.rig.is_empty() {
        draw = draw.only(&options.rig)?;
    }
    let count = draw.count();
    let progress = |done| eprint!("\r{done} of {count} rigs");
    draw.write(&Folders::new(options.out), options.threads, progress)
}
