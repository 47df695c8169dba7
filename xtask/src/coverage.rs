//! Coverage: the controller's own tests must run every line and every branch of it; otherwise the step fails and names
//! them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use std::{fmt, fs};

use crate::failure::Failure;
use crate::process;
use crate::report::Report;
use crate::toolchain::sysroot;
use crate::workspace::{cargo, entries, root, target_dir};

/// Timeout for building and running the controller's tests with counters.
const DEADLINE: Duration = Duration::from_secs(900);
/// Timeout of a tool that only reads the counts.
const TOOL_DEADLINE: Duration = Duration::from_secs(120);

const PACKAGE: &str = "retarder-controller";
const SOURCES: &str = "controller/src";

/// Runs the controller's tests with counters, and fails if a line or branch was not run.
pub(crate) fn check(report: &mut Report) {
    report.step("coverage of the controller", || {
        let tools = Tools::ready()?;
        let covered = Coverage::read(&tools.count()?, &root().join(SOURCES));
        eprintln!("{covered}");
        covered.whole()
    });
}

/// The two programs beside the compiler that read the output of instrumented programs.
struct Tools {
    profdata: PathBuf,
    cov: PathBuf,
}

impl Tools {
    /// Returns the tools of the toolchain in use, installed by rustup if they are missing.
    fn ready() -> Result<Self, Failure> {
        if let Some(tools) = Self::found()? {
            return Ok(tools);
        }
        let skipped = || Failure::Skipped {
            what: "llvm-cov beside the compiler".to_owned(),
            paste: "rustup component add llvm-tools".to_owned(),
        };
        let mut add = Command::new("rustup");
        if let Err(failure) =
            process::run(add.args(["component", "add", "llvm-tools"]), TOOL_DEADLINE)
        {
            eprintln!("{failure}");
            return Err(skipped());
        }
        Self::found()?.ok_or_else(skipped)
    }

    fn found() -> Result<Option<Self>, Failure> {
        let libraries = sysroot("rustc")?.join("lib/rustlib");
        let folders = entries(&libraries)?;
        Ok(folders.into_iter().find_map(|folder| {
            let tools = Self {
                profdata: folder.join("bin/llvm-profdata"),
                cov: folder.join("bin/llvm-cov"),
            };
            (tools.profdata.is_file() && tools.cov.is_file()).then_some(tools)
        }))
    }

    /// Returns the counts of one run of the tests, as an LCOV trace.
    fn count(&self) -> Result<String, Failure> {
        let target = target_dir().join("coverage");
        let profiles = target.join("profiles");
        // Counts of an earlier run would hide gaps of this one.
        let _ = fs::remove_dir_all(&profiles);
        let tests = |arguments: &[&str]| {
            let mut tests = cargo();
            tests.args(["test", "--package", PACKAGE, "--lib", "--tests"]);
            tests.args(arguments);
            // The option that counts branches is unstable; a stable compiler accepts it only with this variable.
            tests.env("RUSTC_BOOTSTRAP", "1");
            tests.env(
                "RUSTFLAGS",
                "-C instrument-coverage -Z coverage-options=branch",
            );
            tests.env("CARGO_TARGET_DIR", &target);
            tests.env("LLVM_PROFILE_FILE", profiles.join("%p-%m.profraw"));
            tests
        };
        process::run(&mut tests(&[]), DEADLINE)?;
        let listed = process::capture(
            &mut tests(&["--no-run", "--message-format", "json"]),
            DEADLINE,
        )?;
        let merged = profiles.join("merged.profdata");
        let mut merge = Command::new(&self.profdata);
        merge.args(["merge", "-sparse", "-o"]).arg(&merged);
        process::run(merge.args(profraw(&profiles)?), TOOL_DEADLINE)?;
        let mut export = Command::new(&self.cov);
        export.args(["export", "-format=lcov", "-instr-profile"]);
        export.arg(&merged);
        for executable in executables(&listed) {
            export.arg("-object").arg(executable);
        }
        process::capture(&mut export, TOOL_DEADLINE)
    }
}

fn profraw(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut paths = entries(folder)?;
    paths.retain(|path| path.extension().is_some_and(|kind| kind == "profraw"));
    Ok(paths)
}

/// Returns the test programs that cargo names in its messages.
fn executables(messages: &str) -> impl Iterator<Item = String> {
    messages.lines().filter_map(|line| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        Some(message.get("executable")?.as_str()?.to_owned())
    })
}

/// Coverage of a folder's files by a run of tests.
#[derive(Debug, Default, PartialEq, Eq)]
struct Coverage {
    files: BTreeMap<PathBuf, Reached>,
}

/// Lines and branches of one file.
#[derive(Debug, Default, PartialEq, Eq)]
struct Reached {
    lines: usize,
    branches: usize,
    missed_lines: Vec<u32>,
    missed_branches: Vec<u32>,
}

impl Coverage {
    /// Reads an LCOV trace; files outside `folder` are left out.
    fn read(trace: &str, folder: &Path) -> Self {
        let mut files = BTreeMap::new();
        let mut file = None;
        for record in trace.lines() {
            let (kind, rest) = record.split_once(':').unwrap_or((record, ""));
            match kind {
                "SF" => {
                    let inside = Path::new(rest).strip_prefix(folder);
                    file = inside.ok().map(Path::to_owned);
                }
                "DA" | "BRDA" => {
                    let (Some(file), Some((line, count))) = (&file, place_and_count(rest)) else {
                        continue;
                    };
                    let reached: &mut Reached = files.entry(file.clone()).or_default();
                    let is_line = kind == "DA";
                    let (all, missed) = if is_line {
                        (&mut reached.lines, &mut reached.missed_lines)
                    } else {
                        (&mut reached.branches, &mut reached.missed_branches)
                    };
                    *all += 1;
                    if count == 0 {
                        missed.push(line);
                    }
                }
                _ => {}
            }
        }
        Self { files }
    }

    fn whole(&self) -> Result<(), Failure> {
        let missed: Vec<String> = self
            .files
            .iter()
            .filter(|(_, reached)| !reached.is_whole())
            .map(|(file, reached)| format!("{SOURCES}/{}: {reached}", file.display()))
            .collect();
        if self.files.is_empty() || !missed.is_empty() {
            return Err(Failure::NotCovered {
                missed: missed.join("\n"),
            });
        }
        Ok(())
    }
}

/// Returns the line at the start of a record and the count at its end; `-` is a branch that was never evaluated.
fn place_and_count(record: &str) -> Option<(u32, u64)> {
    let (line, _) = record.split_once(',')?;
    let (_, count) = record.rsplit_once(',')?;
    let count = if count == "-" { 0 } else { count.parse().ok()? };
    Some((line.parse().ok()?, count))
}

impl Reached {
    fn is_whole(&self) -> bool {
        self.missed_lines.is_empty() && self.missed_branches.is_empty()
    }
}

impl fmt::Display for Reached {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            missed_lines,
            missed_branches,
            ..
        } = self;
        write!(
            f,
            "lines never run {missed_lines:?}, lines with a branch never taken {missed_branches:?}"
        )
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let total = |count: fn(&Reached) -> usize| self.files.values().map(count).sum::<usize>();
        let lines = total(|reached| reached.lines);
        let branches = total(|reached| reached.branches);
        write!(
            f,
            "{SOURCES}: {} of {lines} lines and {} of {branches} branches run",
            lines - total(|reached| reached.missed_lines.len()),
            branches - total(|reached| reached.missed_branches.len()),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACE: &str = "SF:/here/src/step.rs\nDA:3,7\nDA:4,0\nBRDA:3,0,0,5\nBRDA:3,0,1,-\nend_of_record\n\
                         SF:/elsewhere/other.rs\nDA:1,0\nend_of_record\n";

    #[test]
    fn what_was_not_run_is_named_by_file_and_line() {
        let covered = Coverage::read(TRACE, Path::new("/here/src"));
        let failure = covered.whole().unwrap_err().to_string();
        assert!(
            failure.contains("step.rs: lines never run [4], lines with a branch never taken [3]"),
            "{failure}"
        );
        assert!(!failure.contains("other.rs"), "{failure}");
        assert_eq!(
            covered.to_string(),
            "controller/src: 1 of 2 lines and 1 of 2 branches run"
        );
    }

    #[test]
    fn a_file_that_was_run_whole_passes_and_no_file_at_all_does_not() {
        let whole = TRACE.replace("DA:4,0", "DA:4,1").replace(",-", ",1");
        assert!(
            Coverage::read(&whole, Path::new("/here/src"))
                .whole()
                .is_ok()
        );
        assert!(Coverage::default().whole().is_err());
    }

    #[test]
    fn test_programs_are_found_among_cargos_messages() {
        let messages =
            "{\"reason\":\"a\",\"executable\":\"/t/suite\"}\n{\"executable\":null}\nnot json\n";
        assert_eq!(executables(messages).collect::<Vec<_>>(), ["/t/suite"]);
    }
}
