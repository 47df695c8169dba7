//! Draws rigs of other kinds from a seed: `evidence/README.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::ended;
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::kinds::draw::{KindsDraw, Wishes};

/// Draw rigs of other kinds from a seed.
#[derive(Parser)]
struct Options {
    /// Folder of the draw; `logs` and `sealed` in it must not exist.
    #[arg(long)]
    out: PathBuf,
    /// Seed.
    #[arg(long)]
    seed: u64,
    /// Number of rigs.
    #[arg(long, default_value_t = 24)]
    rigs: usize,
    /// Number of hidden effects of each rig, 0 to 5; without this option 0 to 2.
    #[arg(long, value_parser = clap::value_parser!(u8).range(0..=5))]
    effects: Option<u8>,
    /// Number of threads.
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let wishes = Wishes {
        effects: options.effects.map(usize::from),
        ..Wishes::default()
    };
    let draw = KindsDraw::new(options.seed, options.rigs, wishes);
    let progress = |done| eprint!("\r{done} of {} rigs", options.rigs);
    let drawn = draw.write(&Folders::new(options.out), options.threads, progress);
    ended(drawn.map(|()| ExitCode::SUCCESS))
}
