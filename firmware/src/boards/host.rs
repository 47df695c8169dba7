//! The developer's own machine: the self-test on standard output.

use std::env;
use std::io::{Write, stdout};
use std::process::ExitCode;

use firmware::self_test::{self, NotShown, Watcher};

/// Names where the self-test flips one bit of its own, as `CONFIGURATION:STEP`: whoever compares the two machines must
/// find it there. Known to the host only; the image cannot be asked to lie.
const CANARY: &str = "FIRMWARE_CANARY";

struct Terminal;

impl Watcher for Terminal {
    fn show(&mut self, line: &str) -> Result<(), NotShown> {
        writeln!(stdout().lock(), "{line}").map_err(|_| NotShown)
    }
}

/// The host's counterpart of reset.
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
