//! False alarm rate of the ECU's detectors on healthy rigs.
//!
//! ```sh
//! cargo run --release -p hil-harness --example false_alarms              # 120 000 samples
//! cargo run --release -p hil-harness --example false_alarms 10000000     # as in docs/safety.md
//! ```
//!
//! Rigs of six kinds (both orifices, chambers of 50, 75 and 125 cm³) with the scatter of the bench, batteries from 22
//! to 30 V, noise on every signal, the built-in reference profiles and random ones, two controllers; each rig for a
//! minute. Exit code 1: there was an alarm; 2: invalid arguments.

mod soak;

use std::process::ExitCode;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use soak::{Alarms, RIG_SAMPLES, soak};

const SEED: u64 = 20_240_601;
const SAMPLES: u32 = 120_000;

fn main() -> ExitCode {
    let asked = std::env::args().nth(1).map(|samples| samples.parse());
    match asked.unwrap_or(Ok(SAMPLES)) {
        Ok(samples) => {
            let alarms = on_all_cores(samples.div_ceil(RIG_SAMPLES));
            println!("seed {SEED}: {alarms}");
            ExitCode::from(u8::from(alarms.total() > 0))
        }
        Err(error) => {
            eprintln!("a number of samples is wanted, such as 10000000: {error}");
            ExitCode::from(2)
        }
    }
}

/// Runs the same rigs on any number of cores.
fn on_all_cores(rigs: u32) -> Alarms {
    let threads = thread::available_parallelism().map_or(1, |threads| threads.get() as u32);
    let share = rigs.div_ceil(threads);
    let done = AtomicU32::new(0);
    let report = || {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(100) {
            eprintln!("{done} of {rigs} rigs");
        }
    };
    let run = |part: u32| {
        let from = (part * share).min(rigs);
        soak(SEED, from, share.min(rigs - from), RIG_SAMPLES, report)
    };
    let parts: Vec<Alarms> = thread::scope(|scope| {
        let parts: Vec<_> = (0..threads)
            .map(|part| scope.spawn(move || run(part)))
            .collect();
        let ended =
            |part: thread::ScopedJoinHandle<'_, Alarms>| part.join().expect("no rig panics");
        parts.into_iter().map(ended).collect()
    });
    parts
        .iter()
        .fold(Alarms::default(), |sum, part| sum.with(part))
}
