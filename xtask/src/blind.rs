//! The blind benchmark of the diagnosis: programs, each of which reads what the ones before wrote.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::process;
use crate::report::Report;
use crate::workspace::{cargo, root, target_dir};

/// Longest wait for any of them: some hundred rigs, each of them simulated and diagnosed.
const DEADLINE: Duration = Duration::from_secs(12 * 3600);

/// Draws rigs unless `draw` has them, lets the command diagnose those that it has not yet diagnosed, and scores.
pub(crate) fn run(report: &mut Report, draw: &Path, seed: u64, share: f64) {
    let built = report.step("programs of the blind benchmark", || {
        let mut build = cargo();
        build.args(["build", "--release"]);
        build.args(["--package", "retarder", "--package", "retarder-tests"]);
        process::run(build.arg("--bins"), DEADLINE)
    });
    if built.is_none() {
        return;
    }
    report.step("rigs drawn", || {
        if draw.join("sealed").exists() {
            return Ok(());
        }
        let (seed, share) = (seed.to_string(), share.to_string());
        let mut program = program("blind-draw");
        program.arg("--out").arg(draw);
        process::run(program.args(["--seed", &seed, "--share", &share]), DEADLINE)
    });
    report.step("rigs diagnosed", || {
        let mut program = program("blind-run");
        program.arg("--draw").arg(draw);
        process::run(program.arg("--retarder").arg(release("retarder")), DEADLINE)
    });
    report.step("pairs fitted with one effect", || {
        let mut program = program("blind-pairs");
        program.arg("--draw").arg(draw);
        process::run(program.arg("--retarder").arg(release("retarder")), DEADLINE)
    });
    report.step("names scored", || {
        process::run(program("blind-score").arg("--draw").arg(draw), DEADLINE)
    });
}

fn program(name: &str) -> Command {
    let mut program = Command::new(release(name));
    program.current_dir(root());
    program
}

fn release(name: &str) -> PathBuf {
    target_dir().join("release").join(name)
}
