//! Robustness tests of the program: damaged files and kills.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::process;
use crate::report::Report;
use crate::workspace::{cargo, root, target_dir};

/// Timeout: a hundred thousand runs.
const DEADLINE: Duration = Duration::from_secs(6 * 3600);

/// Runs the command on `cases` damaged files, `jobs` at a time.
pub(crate) fn damage(report: &mut Report, cases: u64, seed: u64, jobs: usize, failures: &Path) {
    run(report, "damaged files", "damage", |program| {
        program.args(["--cases", &cases.to_string(), "--seed", &seed.to_string()]);
        program
            .args(["--jobs", &jobs.to_string(), "--failures"])
            .arg(failures);
    });
}

/// Kills the command and the server, each `kills` times.
pub(crate) fn kills(report: &mut Report, kills: u64, seed: u64) {
    run(report, "kills", "kills", |program| {
        program.args(["--kills", &kills.to_string(), "--seed", &seed.to_string()]);
    });
}

/// Builds the command and the driver `name`, and runs it.
fn run(report: &mut Report, what: &'static str, name: &str, options: impl FnOnce(&mut Command)) {
    let built = report.step("the command and its driver", || {
        let mut build = cargo();
        build.args([
            "build",
            "--release",
            "--package",
            "retarder",
            "--package",
            "retarder-tests",
        ]);
        process::run(build.args(["--bin", "retarder", "--bin", name]), DEADLINE)
    });
    if built.is_none() {
        return;
    }
    report.step(what, || {
        let released = target_dir().join("release");
        let mut program = Command::new(released.join(name));
        program
            .current_dir(root())
            .arg("--retarder")
            .arg(released.join("retarder"));
        options(&mut program);
        process::run(&mut program, DEADLINE)
    });
}
