//! Draws field rigs from a seed: `docs/field-benchmark.md`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use retarder_tests::blind::draw::DrawError;
use retarder_tests::blind::ended;
use retarder_tests::blind::field::draw::{Effects, FieldDraw};
use retarder_tests::blind::format::Folders;

/// Draw field rigs from a seed.
#[derive(Parser)]
struct Options {
    /// Folder of the draw; `logs` and `sealed` in it must not exist.
    #[arg(long)]
    out: PathBuf,
    /// Seed.
    #[arg(long)]
    seed: u64,
    /// Number of rigs.
    #[arg(long, default_value_t = 100)]
    rigs: usize,
    /// Numbers of rigs; without this option all of them.
    #[arg(long)]
    rig: Vec<usize>,
    /// Number of hidden effects of each rig, or a range as in 0..4.
    #[arg(long, default_value = "0")]
    effects: Effects,
    /// Noise and converter steps of the loggers relative to those of the seed; 0.1 for ten times better sensors.
    #[arg(long, default_value_t = 1.0)]
    sensor_share: f64,
    /// Number of threads.
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

fn main() -> ExitCode {
    ended(draw(Options::parse()).map(|()| ExitCode::SUCCESS))
}

fn draw(options: Options) -> Result<(), DrawError> {
    let mut draw = FieldDraw::new(options.seed, options.rigs, options.effects)
        .with_sensor_share(options.sensor_share);
    if !options.rig.is_empty() {
        draw = draw.only(&options.rig)?;
    }
    let count = draw.count();
    let progress = |done| eprint!("\r{done} of {count} rigs");
    draw.write(&Folders::new(options.out), options.threads, progress)
}
