//! Fault-injection campaign: breaks plant, sensor, link and ECU in many runs, and checks that the loop stays safe and
//! recovers.
//!
//! ```sh
//! cargo run --release -p hil-harness --example campaign                              # 2000 runs
//! cargo run --release -p hil-harness --example campaign -- --runs 100000 --seed 7    # as in docs/evidence.md
//! cargo run --release -p hil-harness --example campaign -- --class sensor/stuck      # one class
//! cargo run --release -p hil-harness --example campaign -- --reproduce '<line>'      # one run, sample by sample
//! cargo run --release -p hil-harness --example campaign -- --dut qemu --runs 100     # the image; --image names its ELF file
//! ```
//!
//! Exit code 0: every requirement was met; 1: a requirement was violated; 2: the campaign could not run. Ctrl-C prints
//! the table of the finished runs.

mod options;
mod trace;

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;

use ecu::{Damage, Ecu, Mode};
use hil_harness::campaign::EcuFault;
use hil_harness::campaign::{
    CampaignError, FaultClass, InProcessTarget, Injection, Summary, Target, run,
};
use indicatif::{ProgressBar, ProgressStyle};
use options::{Dut, Options, Work};

fn main() -> ExitCode {
    match Options::from_arguments(std::env::args().skip(1)).and_then(|options| work(&options)) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// Carries out the requested work, and returns the number of runs that violated a requirement.
fn work(options: &Options) -> Result<u32, String> {
    match &options.work {
        Work::Reproduce(injection) => {
            let mut target = target(options)?;
            trace::print(injection, target.as_mut()).map_err(|error| error.to_string())
        }
        Work::Campaign {
            runs,
            seed,
            classes,
        } => {
            let stop = Arc::new(AtomicBool::new(false));
            let asked = Arc::clone(&stop);
            ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed))
                .map_err(|error| error.to_string())?;
            campaign(options, *runs, *seed, classes, &stop)
        }
    }
}

fn campaign(
    options: &Options,
    runs: u64,
    seed: u64,
    classes: &[FaultClass],
    stop: &AtomicBool,
) -> Result<u32, String> {
    let first = target(options)?;
    let identity = first.identity();
    let possible = |class: &FaultClass| first.breaks(*class);
    let classes: Vec<FaultClass> = classes.iter().copied().filter(possible).collect();
    if classes.is_empty() {
        return Err(format!("{identity} cannot be broken in this way"));
    }
    drop(first);
    let style = ProgressStyle::with_template("{wide_bar} {pos} of {len} runs, {eta} left")
        .map_err(|error| error.to_string())?;
    let progress = ProgressBar::new(runs).with_style(style);
    let next = AtomicU64::new(0);
    let part = || -> Result<Summary, String> {
        let mut target = target(options)?;
        let mut summary = Summary::default();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= runs || stop.load(Ordering::Relaxed) {
                return Ok(summary);
            }
            let injection = Injection::drawn(&classes, seed, index);
            summary.add(
                run(&injection, target.as_mut())
                    .map_err(|error: CampaignError| error.to_string())?,
            );
            progress.inc(1);
        }
    };
    let threads = match options.dut {
        Dut::InProcess => thread::available_parallelism().map_or(1, usize::from),
        Dut::Qemu => 1,
    };
    let parts: Vec<Result<Summary, String>> = thread::scope(|scope| {
        let parts: Vec<_> = (0..threads).map(|_| scope.spawn(part)).collect();
        let ended = |part: thread::ScopedJoinHandle<'_, _>| {
            part.join()
                .unwrap_or_else(|_| Err("a run panicked".to_owned()))
        };
        parts.into_iter().map(ended).collect()
    });
    progress.finish_and_clear();
    let mut summary = Summary::default();
    for part in parts {
        summary = summary.with(part?);
    }
    println!("{identity}, seed {seed}\n{summary}");
    Ok(summary.failed())
}

fn target(options: &Options) -> Result<Box<dyn Target>, String> {
    match options.dut {
        Dut::InProcess => Ok(Box::new(InProcessTarget::whole().damaged_by(damage))),
        Dut::Qemu => qemu(options),
    }
}

/// Damages the memory of an ECU in this process; returns whether that changed it.
fn damage(ecu: &mut Ecu, fault: EcuFault) -> bool {
    match fault {
        EcuFault::ConfigDamaged => ecu.damage(Damage::Config),
        // The damage sets the mode to running, which has no effect if it is running already.
        EcuFault::SupervisorDamaged if ecu.mode() == Mode::Running => return false,
        EcuFault::SupervisorDamaged => ecu.damage(Damage::Supervisor),
        EcuFault::ControllerDamaged => ecu.damage(Damage::Controller),
        _ => return false,
    }
    true
}

#[cfg(unix)]
fn qemu(options: &Options) -> Result<Box<dyn Target>, String> {
    let target = hil_harness::campaign::EmulatedTarget::start(options.image.as_deref());
    Ok(Box::new(target.map_err(|error| error.to_string())?))
}

#[cfg(not(unix))]
fn qemu(_: &Options) -> Result<Box<dyn Target>, String> {
    Err("the emulated machine's memory can be shared on Unix only".to_owned())
}
