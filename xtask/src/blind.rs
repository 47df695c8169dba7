//! Blind benchmarks of diagnosis and estimation, as programs that each read the output of the previous one.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::process;
use crate::report::Report;
use crate::workspace::{cargo, root, target_dir};

/// Timeout of a program: some hundred rigs are simulated and diagnosed.
const DEADLINE: Duration = Duration::from_secs(12 * 3600);

/// Draws rigs unless `draw` has them, runs the diagnosis on those without a result, and scores.
pub(crate) fn run(report: &mut Report, draw: &Path, seed: u64, share: f64) {
    if !build(report) {
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

/// Draws field rigs unless `draw` has them, refines those without a result, and scores. With a number of hidden
/// `effects`, also diagnoses the rigs and scores the named effects.
pub(crate) fn field(
    report: &mut Report,
    draw: &Path,
    seed: u64,
    rigs: usize,
    effects: Option<&str>,
) {
    if !build(report) {
        return;
    }
    report.step("field rigs drawn", || {
        if draw.join("sealed").exists() {
            return Ok(());
        }
        let (seed, rigs) = (seed.to_string(), rigs.to_string());
        let mut program = program("field-draw");
        program.arg("--out").arg(draw);
        if let Some(effects) = effects {
            program.args(["--effects", effects]);
        }
        process::run(program.args(["--seed", &seed, "--rigs", &rigs]), DEADLINE)
    });
    let with_retarder = |name| {
        let mut program = program(name);
        program.arg("--retarder").arg(release("retarder"));
        program
    };
    let (mut run, mut score) = (with_retarder("field-run"), program("field-score"));
    if effects.is_some() {
        run.arg("--names");
        score.arg("--names");
        on_draw(report, "plants refined, rigs diagnosed", draw, run);
        on_draw(report, "names scored", draw, score);
    } else {
        on_draw(report, "plant files refined", draw, run);
        let truth = with_retarder("field-truth");
        on_draw(report, "true parameters judged", draw, truth);
        on_draw(report, "plants scored", draw, score);
    }
}

/// Runs a program on a draw as a step.
fn on_draw(report: &mut Report, step: &'static str, draw: &Path, mut program: Command) {
    report.step(step, || {
        process::run(program.arg("--draw").arg(draw), DEADLINE)
    });
}

/// Builds the programs and the command.
fn build(report: &mut Report) -> bool {
    let built = report.step("programs of the blind benchmarks", || {
        let mut build = cargo();
        build.args(["build", "--release"]);
        build.args(["--package", "retarder", "--package", "retarder-tests"]);
        process::run(build.arg("--bins"), DEADLINE)
    });
    built.is_some()
}

fn program(name: &str) -> Command {
    let mut program = Command::new(release(name));
    program.current_dir(root());
    program
}

fn release(name: &str) -> PathBuf {
    target_dir().join("release").join(name)
}
