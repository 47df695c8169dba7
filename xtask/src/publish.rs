//! Whether the library crates could be published as they are.

use std::time::Duration;

use crate::process;
use crate::report::Report;
use crate::workspace::cargo;

/// The crates that others may depend on, in one command so that those that need each other find each other unpublished.
const LIBRARIES: [&str; 5] = [
    "retarder-controller",
    "recording",
    "plant-sim",
    "model-lab",
    "hil-harness",
];

const DEADLINE: Duration = Duration::from_secs(1200);

/// Packs and builds each library as its users would get it; uploads nothing.
pub(crate) fn check(report: &mut Report, allow_dirty: bool) {
    report.step("publish, dry run", || {
        let mut publish = cargo();
        publish.args(["publish", "--dry-run"]);
        for library in LIBRARIES {
            publish.args(["--package", library]);
        }
        if allow_dirty {
            publish.arg("--allow-dirty");
        }
        process::run(&mut publish, DEADLINE)
    });
}
