//! The developer's machine: the self-test on standard output.

use std::env;
use std::io::{Write, stdout};
use std::process::ExitCode;

use firmware::self_test::{self, NotShown, Watcher};

/// Environment variable with the place where the self-test flips one bit on purpose, as `CONFIGURATION:STEP`. A
/// comparison of two machines must find it there. Only the host supports it; the image cannot falsify its result.
const CANARY: &str = "FIRMWARE_CANARY";

struct Terminal;

impl Watcher for Terminal {
    fn show(&mut self, line: &str) -> Result<(), NotShown> {
        writeln!(stdout().lock(), "{line}").map_err(|_| NotShown)
    }
}

/// Runs the program: the host's counterpart of a reset.
pub(crate) fn run() -> ExitCode {
    let canary = env::var(CANARY).unwrap_or_default();
    let place = canary.split_once(':');
    let place = place.and_then(|(name, step)| Some((name, step.parse().ok()?)));
    let flip = |name: &str, step| u32::from(place == Some((name, step)));
    match self_test::run(&mut Terminal, flip) {
        Ok(()) => ExitCode::SUCCESS,
        Err(_) => ExitCode::FAILURE,
    }
}
