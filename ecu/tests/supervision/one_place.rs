//! Counts of the places that a new setting or a new fault touches.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use ecu::controller::Field;
use ecu::{EcuField, Fault};

/// Folder of the repository.
const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Folder of the crates that are evidence.
const EVIDENCE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../evidence");

/// Source that uses settings but passes none on: the controllers in C, the configurations of the self-test, the bounds of
/// a rig, the gains that a search changes and the faults of a campaign.
const USES: [&str; 5] = [
    "evidence/budgets/src/",
    "firmware/src/self_test/",
    "hil-harness/src/supervision.rs",
    "hil-harness/src/gain_search/",
    "hil-harness/src/campaign/",
];

/// Source file: its path in the repository, and its words without comments.
struct Source {
    path: String,
    words: BTreeSet<String>,
}

impl Source {
    fn has(&self, word: &str) -> bool {
        self.words.contains(word)
    }
}

/// Returns the source files of the crates: those in `src` without their tests, or those in `tests`.
fn sources(folder: &str) -> Vec<Source> {
    let mut files = Vec::new();
    for parent in [REPOSITORY, EVIDENCE] {
        for entry in fs::read_dir(parent).unwrap() {
            let path = entry.unwrap().path().join(folder);
            if path.is_dir() {
                collect(&path, &mut files);
            }
        }
    }
    assert!(files.len() > 10, "{} files", files.len());
    let words = |path: &PathBuf| {
        let text = fs::read_to_string(path).unwrap();
        let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or("");
        code.lines()
            .flat_map(|line| {
                let code = line.split("//").next().unwrap_or("");
                // Names between backticks are prose of a text.
                let code = code.split('`').step_by(2);
                code.flat_map(|code| {
                    code.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':')
                })
            })
            .map(|word| word.trim_end_matches(':').to_owned())
            .collect()
    };
    files
        .iter()
        .map(|path| Source {
            path: path
                .strip_prefix(REPOSITORY)
                .unwrap()
                .to_string_lossy()
                .into_owned(),
            words: words(path),
        })
        .collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "rs")
            && !["tests.rs", "one_place.rs"]
                .map(Path::new)
                .iter()
                .any(|own| path.ends_with(own))
        {
            files.push(path);
        }
    }
}

/// Returns the files of `src` that pass settings on.
fn without_uses() -> Vec<Source> {
    let mut files = sources("src");
    files.retain(|file| !USES.iter().any(|uses| file.path.starts_with(uses)));
    files
}

fn paths(files: &[Source], is_one: impl Fn(&Source) -> bool) -> BTreeSet<&str> {
    let found = files.iter().filter(|file| is_one(file));
    found.map(|file| file.path.as_str()).collect()
}

/// Returns the files that name more than half of these, each by one of its names.
fn lists<'a>(files: &'a [Source], all: &[Vec<String>]) -> BTreeSet<&'a str> {
    paths(files, |file| {
        let named = all
            .iter()
            .filter(|names| names.iter().any(|name| file.has(name)));
        2 * named.count() > all.len()
    })
}

/// Goal: a setting is described in one place. Method: the files that name most settings are their struct and their table;
/// one more file converts those of the ECU.
#[test]
fn no_file_lists_the_settings_beside_their_struct_and_their_table() {
    let files = without_uses();
    let variants = Field::ALL.map(|field| vec![format!("{field:?}"), format!("Field::{field:?}")]);
    assert_eq!(
        lists(&files, &variants),
        BTreeSet::from(["controller/src/table.rs"])
    );
    let names = Field::ALL.map(|field| {
        let keys = field.spec().keys.iter().map(|key| (*key).to_owned());
        keys.chain([field.name().to_owned()]).collect()
    });
    assert_eq!(
        lists(&files, &names),
        BTreeSet::from(["controller/src/settings.rs", "controller/src/table.rs"])
    );
    let names = EcuField::ALL.map(|field| {
        vec![
            field.name().to_owned(),
            format!("{field:?}"),
            format!("EcuField::{field:?}"),
        ]
    });
    assert_eq!(
        lists(&files, &names),
        BTreeSet::from([
            "ecu/src/config.rs",
            "ecu/src/settings.rs",
            "ecu/src/table.rs"
        ])
    );
}

/// CONTRIBUTING.md, "Add a setting": three places.
#[test]
fn a_setting_stands_in_its_struct_its_table_and_its_mechanism() {
    let files = without_uses();
    let places = |names: &[&str]| paths(&files, |file| names.iter().any(|name| file.has(name)));
    assert_eq!(
        places(&[
            "response_bar",
            "boost_response_bar",
            "BoostResponse",
            "Field::BoostResponse"
        ]),
        BTreeSet::from([
            "controller/src/boost.rs",
            "controller/src/settings.rs",
            "controller/src/table.rs"
        ])
    );
    assert_eq!(
        places(&["battery_min_v", "BatteryMin", "Field::BatteryMin"]),
        BTreeSet::from([
            "ecu/src/config.rs",
            "ecu/src/settings.rs",
            "ecu/src/table.rs"
        ])
    );
}

/// CONTRIBUTING.md, "Add a fault": five places.
#[test]
fn a_fault_stands_in_its_table_its_detector_and_two_tables_of_tests() {
    let mut files = sources("src");
    files.extend(sources("tests"));
    let faults = Fault::ALL.map(|fault| vec![format!("{fault:?}"), format!("Fault::{fault:?}")]);
    assert_eq!(
        lists(&files, &faults),
        BTreeSet::from([
            "ecu/src/fault.rs",
            "ecu/tests/supervision/detection.rs",
            "hil-harness/tests/campaign.rs",
        ])
    );
    let places = paths(&files, |file| {
        ["Fault::BatteryLow", "BatteryDetector"]
            .iter()
            .any(|name| file.has(name))
            || file.path == "ecu/src/fault.rs"
    });
    assert_eq!(
        places,
        BTreeSet::from([
            "ecu/src/detector/mod.rs",
            "ecu/src/detector/battery.rs",
            "ecu/src/fault.rs",
            "ecu/tests/supervision/detection.rs",
            "hil-harness/tests/campaign.rs",
        ])
    );
}
