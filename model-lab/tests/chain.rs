//! From a file to a comparison: the seeds of the fuzz targets satisfy the requirement that the targets test.

mod properties;

use std::fs;
use std::path::{Path, PathBuf};

use recording::csv::{Mapping, Options, read};

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../recording/tests")
        .join(folder);
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

#[test]
fn the_seeds_of_the_fuzzer_are_compared_or_refused() {
    for path in files("corpus/wrong").iter().chain(&files("corpus/good")) {
        properties::csv_to_comparison(&fs::read(path).unwrap());
    }
    for folder in [
        "corpus/mapping-wrong",
        "corpus/mapping-good",
        "corpus/out-of-bounds",
    ] {
        for path in files(folder) {
            properties::mapping_to_comparison(&fs::read_to_string(path).unwrap());
        }
    }
    for path in files("fixtures/mf4") {
        properties::mf4_to_comparison(&fs::read(path).unwrap());
    }
}

/// Defect seen: a sensor with thousandfold pressures, most of them beyond the bounds, caused a panic, or an allocation for each bar.
#[test]
fn the_mapping_that_stays_within_half_is_compared_and_says_what_is_missing() {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../recording/tests/corpus/out-of-bounds");
    let mapping = Mapping::read_file(folder.join("scale-1000.toml")).unwrap();
    let options = Options {
        mapping,
        ..Options::default()
    };
    let log = fs::read(folder.join("log.csv")).unwrap();
    let recording = read("log.csv", log.as_slice(), &options).unwrap();
    properties::compared(&recording);
    let plant = plant_sim::PlantParameters::nominal();
    let found =
        model_lab::compare(&plant, &recording, &model_lab::CompareOptions::default()).unwrap();
    let missing = &found.defects.missing[0];
    assert_eq!(
        (&missing.signal[..], missing.cells, missing.out_of_bounds),
        ("p_ch", 45, 45)
    );
    assert!(
        found.defects.sentences[0].contains("line 9, column 4: -5.101"),
        "{:?}",
        found.defects
    );
}

/// Damaged copies of the log: cells replaced, rows removed.
#[test]
fn damaged_logs_are_compared_or_refused() {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../recording/tests/corpus/out-of-bounds");
    let log = fs::read_to_string(folder.join("log.csv")).unwrap();
    let cells = [
        "", "0", "-1.0", "-1.012", "100", "998", "1e200", "-1e9", "999", "1e-300", "-0.0",
    ];
    let mut seed = 7_u64;
    let mut random = |below: usize| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    for _ in 0..200 {
        let mut rows: Vec<Vec<String>> = log
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect())
            .collect();
        for _ in 0..1 + random(4) {
            let (row, column) = (1 + random(rows.len() - 1), random(7));
            let length = [1, 1, 12, 50][random(4)];
            let cell = cells[random(cells.len())];
            match random(4) {
                0 => {
                    let end = (row + length).min(rows.len() - 1);
                    rows.drain(row.min(end)..end);
                }
                _ => {
                    for row in rows.iter_mut().skip(row).take(length) {
                        row[column] = cell.to_owned();
                    }
                }
            }
        }
        let text: String = rows.iter().map(|row| row.join(",") + "\n").collect();
        properties::csv_to_comparison(text.as_bytes());
    }
}
