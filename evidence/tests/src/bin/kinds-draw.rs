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
    /// Lengths of the id log and of the check log (s); without this option 60 to 90 s and 40 to 50 s.
    #[arg(long, num_args = 2, value_names = ["ID", "CHECK"])]
    lengths_s: Option<Vec<f64>>,
    /// Rows per second (Hz); without this option 20 to 1000.
    #[arg(long)]
    rate_hz: Option<f64>,
    /// Number of threads.
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let wishes = Wishes {
        effects: options.effects.map(usize::from),
        lengths_s: options.lengths_s.map(|lengths| [lengths[0], lengths[1]]),
        rate_hz: options.rate_hz,
    };
    let draw = KindsDraw::new(options.seed, options.rigs, wishes);
    let progress = |done| eprint!("\r{done} of {} rigs", options.rigs);
    let drawn = draw.write(&Folders::new(options.out), options.threads, progress);
    ended(drawn.map(|()| ExitCode::SUCCESS))
}
