//! Mutation tests: each change of the code must fail a test. Changes that no test can detect are in a list with a
//! reason, and that list is compared with the survivors.
//!
//! The whole takes long, so the CI runs one part of each crate, selected by the commit; `cargo xtask mutants` runs
//! everything.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use std::{fmt, fs, io, str};

use clap::ValueEnum;
use serde::Deserialize;

use crate::failure::Failure;
use crate::process;
use crate::report::Report;
use crate::workspace::{cargo, commit_number, find_program, root, target_dir};

/// Version of the tool whose names of mutants the lists use.
const VERSION: &str = "27.1.0";
const INSTALL_DEADLINE: Duration = Duration::from_secs(900);
/// Timeout of one whole crate on one core.
const DEADLINE: Duration = Duration::from_secs(4 * 3600);
/// Timeout of the tests (s): a mutant with an endless loop is stopped, and counts as caught.
const TEST_SECONDS: &str = "60";
/// Number of parts. One part takes about a minute, and one minute more if a mutant makes a loop endless.
const CI_PARTS: u32 = 20;
/// Limit of the survivors, in percent of all mutants that compile.
const MOST_SURVIVORS_PERCENT: usize = 1;

/// Crate whose tests are tested.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Subject {
    /// Controller.
    Controller,
    /// Code that decides whether the coils get the controller's output.
    Ecu,
}

impl Subject {
    const ALL: [Self; 2] = [Self::Controller, Self::Ecu];

    fn step(self) -> &'static str {
        match self {
            Self::Controller => "mutants of the controller",
            Self::Ecu => "mutants of the supervisor",
        }
    }

    fn part_step(self) -> &'static str {
        match self {
            Self::Controller => "a part of the controller's mutants",
            Self::Ecu => "a part of the supervisor's mutants",
        }
    }

    fn package(self) -> &'static str {
        match self {
            Self::Controller => "retarder-controller",
            Self::Ecu => "retarder-ecu",
        }
    }

    fn folder(self) -> &'static str {
        match self {
            Self::Controller => "controller",
            Self::Ecu => "ecu",
        }
    }

    /// Returns the files with mutants; empty for all files.
    fn files(self) -> &'static [&'static str] {
        match self {
            Self::Controller => &[],
            Self::Ecu => &[
                "ecu/src/ecu.rs",
                "ecu/src/supervisor/mod.rs",
                "ecu/src/supervisor/**",
                "ecu/src/detector/mod.rs",
                "ecu/src/detector/**",
                "ecu/src/valve.rs",
                "ecu/src/history.rs",
                "ecu/src/counted.rs",
            ],
        }
    }

    /// Returns the tests that each mutant runs: those that end within a second or two. The long tests, which are random
    /// or compare with other arithmetic, find hardly any additional mutants.
    fn tests(self) -> &'static [&'static str] {
        match self {
            Self::Controller => &[
                "--lib",
                "--test",
                "suite",
                "--",
                "--skip",
                "reference::",
                "--skip",
                "golden::",
                "--skip",
                "invariants::",
                "--skip",
                "state::a_restored",
                "--skip",
                "state::any_words",
                "--skip",
                "state::extreme",
            ],
            Self::Ecu => &["--lib", "--test", "supervision"],
        }
    }
}

/// Part `k` of `n`, in the tool's notation: `0/n` to `n-1/n`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    part: u32,
    of: u32,
}

impl str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let shard = parts.and_then(|(part, of)| {
            Some(Self {
                part: part.parse().ok()?,
                of: of.parse().ok()?,
            })
        });
        let shard = shard.filter(|shard| shard.part < shard.of);
        shard.ok_or_else(|| format!("`{text}` is no part such as 0/8 or 7/8"))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.part, self.of)
    }
}

/// Tests every mutant of these crates, or the requested part.
pub(crate) fn check(report: &mut Report, subject: Option<Subject>, shard: Option<Shard>) {
    for one in Subject::ALL {
        if subject.is_none_or(|wanted| wanted == one) {
            report.step(one.step(), || judge(one, shard));
        }
    }
}

/// Tests the part of each crate's mutants that this commit selects: the same commit always selects the same part.
pub(crate) fn check_a_part(report: &mut Report) {
    for one in Subject::ALL {
        report.step(one.part_step(), || {
            let part = commit_number()? % CI_PARTS;
            judge(one, Some(Shard { part, of: CI_PARTS }))
        });
    }
}

fn judge(subject: Subject, shard: Option<Shard>) -> Result<(), Failure> {
    let listed = root().join(subject.folder()).join("mutants.toml");
    let listed = read(&listed, Listed::parse)?;
    let found = read(&run(subject, shard)?, Found::parse)?;
    eprintln!("{found}");
    found.agrees(&listed, shard.is_none())
}

/// Runs the tool on a copy of the tree and returns the file of its outcomes.
fn run(subject: Subject, shard: Option<Shard>) -> Result<PathBuf, Failure> {
    let out = target_dir().join("mutants").join(subject.folder());
    let outcomes = out.join("mutants.out/outcomes.json");
    // Outcomes of an earlier run are not findings of this one.
    let _ = fs::remove_file(&outcomes);
    make_folder(&out)?;
    let mut mutants = Command::new(tool()?);
    mutants.current_dir(root());
    mutants.args(["mutants", "--package", subject.package()]);
    mutants.args(["--timeout", TEST_SECONDS, "--no-shuffle", "--output"]);
    mutants.arg(&out);
    if let Some(shard) = shard {
        // Round robin: with parts of consecutive mutants, the last of twenty was empty, which is an error.
        mutants.args(["--shard", &shard.to_string(), "--sharding", "round-robin"]);
    }
    for file in subject.files() {
        mutants.args(["--file", file]);
    }
    mutants.arg("--").args(subject.tests());
    // Every mutant is built and its tests are short: the compiler's time dominates.
    mutants.env("CARGO_PROFILE_DEV_OPT_LEVEL", "0");
    mutants.env("CARGO_PROFILE_DEV_DEBUG", "0");
    // Random tests draw fewer cases, since there are hundreds of runs.
    mutants.env("PROPTEST_CASES", "32");
    // The tool fails if a mutant survives. The outcomes decide about that; without outcomes it has not run.
    let ended = process::run(&mut mutants, DEADLINE);
    match (ended, outcomes.is_file()) {
        (_, true) => Ok(outcomes),
        (Err(failure), false) => Err(failure),
        (Ok(()), false) => Err(Failure::File {
            path: outcomes,
            source: io::ErrorKind::NotFound.into(),
        }),
    }
}

/// Returns the tool; builds it once into the target folder if it is not installed.
fn tool() -> Result<PathBuf, Failure> {
    if let Some(tool) = find_program("cargo-mutants") {
        return Ok(tool);
    }
    let folder = target_dir().join("tools");
    let tool = folder.join("bin/cargo-mutants");
    if !tool.is_file() {
        let mut install = cargo();
        install.args(["install", "--locked", "cargo-mutants", "--version", VERSION]);
        // It mostly waits for compilers: a short build matters more than a fast program.
        install.arg("--debug");
        process::run(install.arg("--root").arg(&folder), INSTALL_DEADLINE)?;
    }
    Ok(tool)
}

fn make_folder(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path).map_err(|source| Failure::File {
        path: path.to_owned(),
        source,
    })
}

/// Reads a file with `parse`.
fn read<T>(path: &Path, parse: impl Fn(&str) -> Result<T, String>) -> Result<T, Failure> {
    let parsed = fs::read_to_string(path).and_then(|text| parse(&text).map_err(io::Error::other));
    parsed.map_err(|source| Failure::File {
        path: path.to_owned(),
        source,
    })
}

/// Mutant without line and column, which change with every edit.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord)]
struct Mutant {
    file: String,
    mutant: String,
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.mutant)
    }
}

/// Known survivors, with the reason why no test can detect them.
#[derive(Debug, Default)]
struct Listed(BTreeMap<Mutant, usize>);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ListFile {
    #[serde(default)]
    survivor: Vec<Survivor>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Survivor {
    file: String,
    mutant: String,
    reason: String,
}

impl Listed {
    fn parse(text: &str) -> Result<Self, String> {
        let list: ListFile = toml::from_str(text).map_err(|error| error.to_string())?;
        let mut listed = Self::default();
        for Survivor {
            file,
            mutant,
            reason,
        } in list.survivor
        {
            let mutant = Mutant { file, mutant };
            if reason.trim().is_empty() {
                return Err(format!("{mutant}: no reason is given"));
            }
            *listed.0.entry(mutant).or_default() += 1;
        }
        Ok(listed)
    }
}

/// Results of one run of the tool.
#[derive(Debug, Default)]
struct Found {
    caught: usize,
    survivors: BTreeMap<Mutant, usize>,
}

#[derive(Deserialize)]
struct Outcomes {
    outcomes: Vec<Outcome>,
}

#[derive(Deserialize)]
struct Outcome {
    scenario: Scenario,
    summary: String,
}

/// Tests of the unchanged code, or one mutant.
#[derive(Deserialize)]
enum Scenario {
    Baseline,
    Mutant { name: String },
}

impl Found {
    fn parse(text: &str) -> Result<Self, String> {
        let all: Outcomes = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let mut found = Self::default();
        for Outcome { scenario, summary } in all.outcomes {
            match (scenario, summary.as_str()) {
                (Scenario::Baseline, "Success") | (_, "Unviable") => {}
                (Scenario::Baseline, _) => return Err("the tests fail without a mutant".to_owned()),
                (_, "CaughtMutant" | "Timeout") => found.caught += 1,
                (Scenario::Mutant { name }, _) => {
                    *found.survivors.entry(without_place(&name)?).or_default() += 1;
                }
            }
        }
        Ok(found)
    }

    fn survived(&self) -> usize {
        self.survivors.values().sum()
    }

    /// Fails for a survivor that is not listed, since a test is missing; only a whole run can find that a listed
    /// survivor is gone.
    fn agrees(&self, listed: &Listed, whole: bool) -> Result<(), Failure> {
        let beyond = |these: &BTreeMap<Mutant, usize>, those: &BTreeMap<Mutant, usize>| {
            let more =
                |mutant: &Mutant, count: usize| count > those.get(mutant).copied().unwrap_or(0);
            let names = these.iter().filter(|(mutant, count)| more(mutant, **count));
            names
                .map(|(mutant, _)| mutant.to_string())
                .collect::<Vec<_>>()
        };
        let unlisted = beyond(&self.survivors, &listed.0);
        if !unlisted.is_empty() {
            return Err(Failure::MutantsLived {
                mutants: unlisted.join("\n"),
            });
        }
        let gone = beyond(&listed.0, &self.survivors);
        if whole && !gone.is_empty() {
            return Err(Failure::MutantsGone {
                mutants: gone.join("\n"),
            });
        }
        let (survived, all) = (self.survived(), self.survived() + self.caught);
        if whole && 100 * survived > MOST_SURVIVORS_PERCENT * all {
            return Err(Failure::TooManyMutants {
                survived,
                all,
                percent: MOST_SURVIVORS_PERCENT,
            });
        }
        Ok(())
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (survived, all) = (self.survived(), self.survived() + self.caught);
        write!(f, "{survived} of {all} mutants survive")
    }
}

/// Returns `controller/src/pid.rs:40:9: replace + with - in Pid::step` without the numbers.
fn without_place(name: &str) -> Result<Mutant, String> {
    let mut parts = name.splitn(4, ':');
    match (parts.next(), parts.nth(2)) {
        (Some(file), Some(mutant)) => Ok(Mutant {
            file: file.to_owned(),
            mutant: mutant.trim().to_owned(),
        }),
        _ => Err(format!("`{name}` is not FILE:LINE:COLUMN: MUTANT")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTCOMES: &str = r#"{"outcomes": [
        {"scenario": "Baseline", "summary": "Success"},
        {"scenario": {"Mutant": {"name": "a/src/x.rs:1:2: replace + with -", "genre": "BinaryOperator"}}, "summary": "MissedMutant"},
        {"scenario": {"Mutant": {"name": "a/src/x.rs:9:2: replace + with -"}}, "summary": "CaughtMutant"},
        {"scenario": {"Mutant": {"name": "a/src/x.rs:9:3: replace + with *"}}, "summary": "Timeout"},
        {"scenario": {"Mutant": {"name": "a/src/x.rs:9:4: replace f with g"}}, "summary": "Unviable"}]}"#;
    const LIST: &str =
        "[[survivor]]\nfile = \"a/src/x.rs\"\nmutant = \"replace + with -\"\nreason = \"equal\"\n";

    #[test]
    fn what_does_not_compile_is_no_mutant_and_what_does_not_end_is_caught() {
        let found = Found::parse(OUTCOMES).unwrap();
        assert_eq!(found.to_string(), "1 of 3 mutants survive");
    }

    #[test]
    fn a_survivor_without_a_reason_in_the_list_is_named_by_part_and_by_whole() {
        let found = Found::parse(OUTCOMES).unwrap();
        for whole in [false, true] {
            let failure = found
                .agrees(&Listed::default(), whole)
                .unwrap_err()
                .to_string();
            assert!(
                failure.contains("a/src/x.rs: replace + with -"),
                "{failure}"
            );
        }
    }

    #[test]
    fn a_second_survivor_with_the_name_of_a_listed_one_is_found() {
        let twice = OUTCOMES.replace("CaughtMutant", "MissedMutant");
        let found = Found::parse(&twice).unwrap();
        assert!(found.agrees(&Listed::parse(LIST).unwrap(), false).is_err());
    }

    #[test]
    fn a_listed_mutant_that_is_caught_now_must_leave_the_list() {
        let caught = OUTCOMES.replace("MissedMutant", "CaughtMutant");
        let found = Found::parse(&caught).unwrap();
        let listed = Listed::parse(LIST).unwrap();
        assert!(found.agrees(&listed, false).is_ok());
        assert!(matches!(
            found.agrees(&listed, true),
            Err(Failure::MutantsGone { .. })
        ));
    }

    #[test]
    fn more_survivors_than_one_in_a_hundred_are_too_many_even_with_reasons() {
        let found = Found::parse(OUTCOMES).unwrap();
        assert!(matches!(
            found.agrees(&Listed::parse(LIST).unwrap(), true),
            Err(Failure::TooManyMutants {
                survived: 1,
                all: 3,
                ..
            })
        ));
    }

    #[test]
    fn a_list_without_a_reason_is_refused() {
        let refused = Listed::parse(&LIST.replace("equal", " ")).unwrap_err();
        assert!(refused.contains("no reason"), "{refused}");
    }

    #[test]
    fn tests_that_fail_without_a_mutant_prove_nothing() {
        assert!(Found::parse(&OUTCOMES.replace("Success", "Failure")).is_err());
    }

    #[test]
    fn a_part_is_less_than_the_whole() {
        assert_eq!("3/8".parse(), Ok(Shard { part: 3, of: 8 }));
        for wrong in ["8/8", "0/0", "3", "a/b", "-1/8"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
