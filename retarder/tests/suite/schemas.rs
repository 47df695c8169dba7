//! Results compared with their published schemas, and the schemas with the types.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::runner::{Bench, data};

/// Results, those of the commands that run here first.
const RESULTS: [&str; 15] = [
    "black-box",
    "comparison",
    "control",
    "device",
    "next-experiment",
    "determining-experiment",
    "inspection",
    "rigs",
    "rig-summary",
    "simulation",
    "thesis",
    "thesis-explanation",
    "diagnosis",
    "refinement",
    "estimation",
];

fn published(result: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../docs/schema/{result}.json"))
}

/// Compares the published schemas with those of the types; `BLESS=1 cargo test -p retarder` writes them again.
#[test]
fn the_published_schemas_are_those_of_the_types() {
    let bench = Bench::new();
    for result in RESULTS {
        let of_type = bench.run(&["schema", result]).ended_with(0);
        if std::env::var_os("BLESS").is_some() {
            fs::create_dir_all(published(result).parent().unwrap()).unwrap();
            fs::write(published(result), &of_type).unwrap();
        }
        let found = fs::read_to_string(published(result)).unwrap_or_default();
        assert_eq!(
            found, of_type,
            "docs/schema/{result}.json is out of date: BLESS=1"
        );
    }
}

/// With `BLESS=1`, stores `json`, a result that takes long, as the example of its schema.
pub(crate) fn keep_example(result: &str, json: &Value) {
    if std::env::var_os("BLESS").is_some() {
        fs::write(
            published(result).with_extension("example.json"),
            format!("{json:#}\n"),
        )
        .unwrap();
    }
}

/// Real results are valid; with one field more or less at any depth, they are invalid.
#[test]
fn results_keep_to_their_schemas_and_nothing_else_does() {
    let bench = Bench::new();
    let log = data("synthetic/practice-01-check.csv");
    let runs: [&[&str]; 12] = [
        &["blackbox", "--dut", "in-process", "--json"],
        &["compare", "--log", &log, "--json"],
        &["control", "--json"],
        &["control", "--dut", "in-process", "--json"],
        &[
            "next-experiment",
            "--log",
            &log,
            "--for",
            "chamber_leak",
            "--duration",
            "5",
            "--json",
        ],
        &[
            "next-experiment",
            "--log",
            &log,
            "--determine",
            "flow.discharge_fill",
            "--duration",
            "5",
            "--json",
        ],
        &[
            "inspect",
            &log,
            &data("unknown/german-logger.csv"),
            "--json",
        ],
        &["control", "--rigs", "1", "--json"],
        &[
            "control",
            "--rigs",
            "1",
            "--rigs-out",
            "rigs.parquet",
            "--json",
        ],
        &["simulate", "--log", &log, "--out", "model.csv", "--json"],
        &["thesis", "--json"],
        &["thesis", "--explain", "--json"],
    ];
    for (result, arguments) in RESULTS.into_iter().zip(runs) {
        let json = serde_json::from_str(&bench.run(arguments).out).unwrap();
        check(&bench, result, &json);
    }
}

#[test]
fn examples_keep_to_their_schemas_and_nothing_else_does() {
    let bench = Bench::new();
    for result in &RESULTS[12..] {
        let path = published(result).with_extension("example.json");
        let json = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        check(&bench, result, &json);
    }
}

fn check(bench: &Bench, result: &str, json: &Value) {
    let schema: Value = serde_json::from_str(&bench.run(&["schema", result]).out).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let problems: Vec<String> = validator
        .iter_errors(json)
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert!(problems.is_empty(), "{result}: {problems:?}");
    let name = json["schema"].as_str().unwrap();
    assert!(name.starts_with(&format!("retarder.{result}/")), "{name}");
    let about = &schema["properties"]["schema"]["description"];
    assert!(about.as_str().unwrap().contains(name), "{name}: {about}");

    let objects = pointers_to_objects(json, String::new());
    assert!(!objects.is_empty());
    for pointer in objects {
        let mut more = json.clone();
        let object = more.pointer_mut(&pointer).unwrap().as_object_mut().unwrap();
        object.insert("surprise".to_owned(), Value::Null);
        assert!(
            !validator.is_valid(&more),
            "{result}: a surprise at `{pointer}` is accepted"
        );
    }
    let mut less = json.clone();
    less.as_object_mut().unwrap().remove("schema");
    assert!(!validator.is_valid(&less), "{result}: no schema");
}

/// Returns every object of the value; of each array the first.
fn pointers_to_objects(value: &Value, pointer: String) -> Vec<String> {
    match value {
        Value::Object(fields) => {
            let inner = fields
                .iter()
                .flat_map(|(name, value)| pointers_to_objects(value, format!("{pointer}/{name}")))
                .collect::<Vec<_>>();
            [vec![pointer], inner].concat()
        }
        Value::Array(items) => items
            .first()
            .map(|item| pointers_to_objects(item, format!("{pointer}/0")))
            .unwrap_or_default(),
        _ => Vec::new(),
    }
}
