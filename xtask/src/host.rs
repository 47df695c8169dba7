//! Steps on this machine: formatting, lints, documentation, tests, examples.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use crate::failure::Failure;
use crate::report::Report;
use crate::tests::Which;
use crate::workspace::{cargo, commit_number, entries, find_program, root, target_dir};
use crate::{axe, packages, process, tests};

/// Timeout of one cargo command. A cold build of everything takes some minutes on two cores.
const DEADLINE: Duration = Duration::from_secs(1500);
/// Timeout of one example.
const EXAMPLE_DEADLINE: Duration = Duration::from_secs(300);
/// Timeout of rustup's download.
const RUSTUP_DEADLINE: Duration = Duration::from_secs(300);

/// Installs the requirements of the other functions of this file.
pub(crate) fn setup(report: &mut Report) {
    report.step("rustfmt and clippy", || {
        component("rustfmt", "fmt")?;
        component("clippy", "clippy")
    });
    report.step("Chromium and its driver", browser_ready);
    report.step("axe-core", axe::ready);
}

/// Formats every file.
pub(crate) fn format(report: &mut Report) {
    report.step("format", || run(&["fmt", "--all"]));
}

/// Checks format and lints, and runs the unit tests that take seconds.
pub(crate) fn fast(report: &mut Report) {
    format_and_clippy(report);
    report.step("unit tests", || tests::run(Which::Fast));
}

/// Checks format, lints and links in the documentation.
pub(crate) fn lint(report: &mut Report) {
    format_and_clippy(report);
    report.step("documentation", || {
        let mut doc = cargo();
        doc.args(["doc", "--workspace", "--no-deps", "--keep-going"]);
        process::run(doc.env("RUSTDOCFLAGS", "-D warnings"), DEADLINE)
    });
}

fn format_and_clippy(report: &mut Report) {
    report.step("format", || {
        component("rustfmt", "fmt")?;
        run(&["fmt", "--all", "--check"])
    });
    report.step("clippy", || {
        component("clippy", "clippy")?;
        run(&[
            "clippy",
            "--workspace",
            "--all-targets",
            "--features",
            tests::FEATURES,
            "--keep-going",
            "--",
            "-D",
            "warnings",
        ])
    });
}

/// Runs tests and examples; of the regression rigs all, or the part that this commit selects.
pub(crate) fn test(report: &mut Report, every_rig: bool) {
    report.step("tests", || tests::run(Which::Alone));
    if every_rig {
        report.step("the regression rigs", || tests::run(Which::Rigs(None)));
    } else {
        report.step("a part of the regression rigs", || {
            tests::run(Which::Rigs(Some(commit_number()? % tests::RIG_PARTS)))
        });
    }
    report.step("tests in the documentation", || {
        run(&[
            "test",
            "--workspace",
            "--doc",
            "--features",
            tests::FEATURES,
            "--no-fail-fast",
        ])
    });
    report.step("the page in a browser", || {
        browser_ready()?;
        axe::ready()?;
        tests::run(Which::Browser)
    });
    report.step("examples", examples);
}

/// Installs Chromium and its driver if they are missing.
fn browser_ready() -> Result<(), Failure> {
    let is_there = |program| find_program(program).is_some();
    if is_there("chromedriver") && is_there("chromium") {
        return Ok(());
    }
    packages::install("Chromium and its driver", &["chromium", "chromium-driver"])
}

/// Runs each example of each crate: it needs no arguments, asserts its claims, and ends.
fn examples() -> Result<(), Failure> {
    run(&[
        "build",
        "--workspace",
        "--examples",
        "--features",
        tests::FEATURES,
    ])?;
    let mut outcome = Ok(());
    for name in example_names()? {
        eprintln!("{}", name.display());
        let mut example = Command::new(target_dir().join("debug/examples").join(name));
        example.current_dir(root());
        if let Err(failure) = process::capture(&mut example, EXAMPLE_DEADLINE) {
            eprintln!("{failure}");
            outcome = outcome.and(Err(failure));
        }
    }
    outcome
}

/// Returns the examples that cargo finds by itself: `CRATE/examples/NAME.rs` and `CRATE/examples/NAME/main.rs`.
fn example_names() -> Result<Vec<PathBuf>, Failure> {
    let mut names = Vec::new();
    let folders = [entries(&root())?, entries(&root().join("evidence"))?].concat();
    for member in folders {
        let folder = member.join("examples");
        if !member.join("Cargo.toml").is_file() || !folder.is_dir() {
            continue;
        }
        for entry in entries(&folder)? {
            let is_example =
                entry.extension() == Some(OsStr::new("rs")) || entry.join("main.rs").is_file();
            if let (true, Some(name)) = (is_example, entry.file_stem()) {
                names.push(PathBuf::from(name));
            }
        }
    }
    Ok(names)
}

/// Installs a component of the toolchain in use by rustup if it is missing.
fn component(name: &str, verb: &str) -> Result<(), Failure> {
    if process::capture(cargo().args([verb, "--version"]), RUSTUP_DEADLINE).is_ok() {
        return Ok(());
    }
    let mut add = Command::new("rustup");
    process::run(add.args(["component", "add", name]), RUSTUP_DEADLINE).map_err(|failure| {
        eprintln!("{failure}");
        Failure::Missing {
            what: name.to_owned(),
            paste: format!("rustup component add {name}"),
        }
    })
}

fn run(arguments: &[&str]) -> Result<(), Failure> {
    process::run(cargo().args(arguments), DEADLINE)
}
