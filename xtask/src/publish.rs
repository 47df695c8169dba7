//! Check that the library crates can be published in their present state.

use std::time::Duration;

use crate::process;
use crate::report::Report;
use crate::workspace::cargo;

const DEADLINE: Duration = Duration::from_secs(1200);

/// Packs and builds each library as its users would get it; uploads nothing.
pub(crate) fn check(report: &mut Report, allow_dirty: bool) {
    report.step("publish, dry run", || {
        let mut publish = cargo();
        // All members except those with `publish = false`; they also find each other while unpublished.
        publish.args(["publish", "--dry-run", "--workspace"]);
        if allow_dirty {
            publish.arg("--allow-dirty");
        }
        process::run(&mut publish, DEADLINE)
    });
}
