//! Tests of this machine: built once, run in parts; one needs a browser and one the image, and one takes seconds.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::failure::Failure;
use crate::process;
use crate::workspace::{cargo, find_program};

/// Features that the tests need. Each part is built with all of them; otherwise cargo would build the dependencies
/// again.
pub(crate) const FEATURES: &str =
    "hil-harness/image-in-the-loop,retarder/image-in-the-loop,workbench/browser";

/// Timeout for build and run of one part. A cold build of everything takes ten minutes on two idle cores.
const DEADLINE: Duration = Duration::from_secs(3600);

/// Selection of the workspace's tests.
#[derive(Clone, Copy)]
pub(crate) enum Which<'a> {
    /// Unit tests that take seconds: not the searches of the diagnosis.
    Fast,
    /// Tests that need nothing but this machine, without the regression rigs.
    Alone,
    /// Rigs that the diagnosis once failed, practice rigs and negative controls, each with a whole search: all of them, or
    /// one part of [`RIG_PARTS`], from 0.
    Rigs(Option<u32>),
    /// Tests of the page in a browser.
    Browser,
    /// Tests with the image in the loop, one at a time: each uses two processors.
    Image(&'a Path),
}

/// Number of parts of the regression rigs. One part takes about five minutes on two cores.
pub(crate) const RIG_PARTS: u32 = 4;

/// Runs some tests of the workspace; all of them run, even if one fails.
pub(crate) fn run(which: Which<'_>) -> Result<(), Failure> {
    let runs = if find_program("cargo-nextest").is_some() {
        vec![by_nextest(which)]
    } else {
        by_cargo(which)
    };
    let mut outcome = Ok(());
    for mut tests in runs {
        if let Which::Image(image) = which {
            tests.env("RETARDER_IMAGE", image);
        }
        outcome = outcome.and(process::run(&mut tests, DEADLINE));
    }
    outcome
}

fn by_nextest(which: Which<'_>) -> Command {
    const FAST: &str = "kind(lib) - (package(model-lab) & test(/^diagnosis::/)) | binary(words) | binary(repository)";
    const BROWSER: &str = "package(workbench) & binary(browser)";
    const IMAGE: &str =
        "package(hil-harness) & binary(/image/) | package(retarder) & test(/^image::/)";
    const RIGS: &str = "package(model-lab) & binary(/^(practice_diagnosis|negative_controls)$/) | \
         package(retarder-tests) & binary(/^(blind_diagnosis|failed_rigs)$/)";
    let mut tests = cargo();
    tests.args(["nextest", "run", "--workspace", "--no-fail-fast"]);
    tests.args(["--features", FEATURES, "--filterset"]);
    match which {
        Which::Fast => tests.arg(FAST),
        Which::Alone => tests.arg(format!("not ({BROWSER} | {IMAGE} | {RIGS})")),
        Which::Rigs(None) => tests.arg(RIGS),
        Which::Rigs(Some(part)) => {
            let part = format!("slice:{}/{RIG_PARTS}", part + 1);
            tests.args([RIGS, "--partition", &part])
        }
        Which::Browser => tests.arg(BROWSER),
        Which::Image(_) => tests.arg(IMAGE).args(["--test-threads", "1"]),
    };
    tests
}

/// Returns the commands for cargo's own runner, which can select whole test programs only.
fn by_cargo(which: Which<'_>) -> Vec<Command> {
    let test = |arguments: &[&str]| {
        let mut tests = cargo();
        tests.args(["test", "--workspace", "--no-fail-fast"]);
        tests.args(arguments);
        tests
    };
    match which {
        Which::Fast => vec![test(&[
            "--features",
            FEATURES,
            "--lib",
            "--",
            "--skip",
            "diagnosis::",
        ])],
        // All tests: it cannot leave the rigs out.
        Which::Alone => vec![test(&["--lib", "--bins", "--tests"])],
        Which::Rigs(_) => Vec::new(),
        Which::Browser => vec![test(&["--features", FEATURES, "--test", "browser"])],
        Which::Image(_) => [
            &["image_in_the_loop", "--"][..],
            &["campaign_on_the_image", "--"],
            &["suite", "image::", "--"],
        ]
        .map(|which| {
            let mut tests = test(&["--features", FEATURES, "--test"]);
            tests.args(which).args(["--test-threads", "1"]);
            tests
        })
        .into(),
    }
}
