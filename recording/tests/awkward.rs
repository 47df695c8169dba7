//! Awkward logs: each comes in as it is, or with the mapping that an inspection writes.

use std::fs;
use std::path::{Path, PathBuf};

use recording::csv::{self, Mapping};
use recording::{
    Inspection, LogOptions, PressureReference, Recording, inspect_file, read_log_file,
};

/// Help with which a log comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Needs {
    /// Nothing at all.
    Nothing,
    /// The mapping that the inspection writes.
    Mapping,
    /// The mapping, after the reference of its pressures is stated.
    Gauge,
    /// The reference of its pressures alone.
    GaugeAlone,
    /// `--skip-bad-rows 1`.
    OneSkippedRow,
}

/// File, its help, number of its rows, number of missing pressures, and the date of its first row.
#[rustfmt::skip]
const LOGS: &[(&str, Needs, usize, usize, Option<&str>)] = &[
    ("carriage-returns.csv", Needs::Nothing, 80, 0, None),
    ("comment-column.csv", Needs::Mapping, 80, 0, None),
    ("cp1252.csv", Needs::Mapping, 80, 0, None),
    ("cut-last-row.csv", Needs::OneSkippedRow, 79, 0, None),
    ("gauge-or-absolute.csv", Needs::GaugeAlone, 80, 0, None),
    ("german-date.csv", Needs::Mapping, 80, 0, Some("2026-11-23 14:05:06 local time")),
    ("glitch.csv", Needs::Mapping, 80, 2, None),
    ("iso-8601.csv", Needs::Mapping, 80, 0, Some("2026-11-23 14:05:06 UTC+01:00")),
    ("latin-1.csv", Needs::Mapping, 80, 0, None),
    ("missing-words.csv", Needs::Mapping, 80, 2, None),
    ("preamble.csv", Needs::Mapping, 80, 0, None),
    ("pwm-counts.csv", Needs::Mapping, 80, 0, None),
    ("semicolon-decimal-comma.csv", Needs::Mapping, 80, 0, None),
    ("several-rates.mf4", Needs::Nothing, 395, 0, Some("2026-11-23 13:05:06 UTC")),
    ("short-names.csv", Needs::Gauge, 80, 0, None),
    ("slow-sensor.csv", Needs::Nothing, 80, 64, None),
    ("state-of-both.csv", Needs::Mapping, 80, 0, None),
    ("thousands.csv", Needs::Mapping, 80, 0, None),
    ("time-of-day.csv", Needs::Mapping, 80, 0, None),
    ("units-row.csv", Needs::Mapping, 80, 0, None),
    ("unix-milliseconds.csv", Needs::Mapping, 80, 0, None),
    ("unix-seconds.csv", Needs::Mapping, 80, 0, None),
    ("utf-16.txt", Needs::Mapping, 80, 0, None),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/awkward")
}

fn options(mapping: Mapping, bad_rows: u64) -> LogOptions {
    LogOptions {
        mapping,
        csv_limits: csv::Limits {
            bad_rows,
            ..csv::Limits::default()
        },
        ..LogOptions::default()
    }
}

/// Inspects a log as a user would, and reads it as the inspection says.
fn read(name: &str, needs: Needs) -> (Inspection, Recording) {
    let path = folder().join(name);
    let bad_rows = u64::from(needs == Needs::OneSkippedRow);
    let is_gauge = matches!(needs, Needs::Gauge | Needs::GaugeAlone);
    let first = inspect_file(&path, &options(Mapping::default(), 0), None).unwrap();
    assert_eq!(first.asks_reference, is_gauge, "{name}: {first:#?}");
    assert_eq!(
        first.is_ready(),
        !is_gauge && bad_rows == 0,
        "{name}: {first:#?}"
    );
    let reference = is_gauge.then_some(PressureReference::Gauge);
    let stated = Mapping::default().with_reference(reference);
    let inspection = inspect_file(&path, &options(stated.clone(), bad_rows), None).unwrap();
    assert!(inspection.is_ready(), "{name}: {inspection:#?}");
    let mapping = match (&inspection.mapping, needs) {
        (None, Needs::Nothing | Needs::GaugeAlone | Needs::OneSkippedRow) => stated,
        (Some(text), Needs::Mapping | Needs::Gauge) => Mapping::parse("mapping", text).unwrap(),
        (mapping, _) => panic!("{name}: {mapping:?}"),
    };
    let recording = read_log_file(&path, &options(mapping, bad_rows));
    (
        inspection,
        recording.unwrap_or_else(|error| panic!("{name}: {error}")),
    )
}

#[test]
fn every_awkward_log_comes_in_as_it_is_or_with_the_mapping_of_its_inspection() {
    let mut files: Vec<String> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| !matches!(&**name, "README.md" | "make.py"))
        .collect();
    files.sort();
    let listed: Vec<&str> = LOGS.iter().map(|(name, ..)| *name).collect();
    assert_eq!(
        files, listed,
        "the table and the folder name the same files"
    );
    let reference = read("semicolon-decimal-comma.csv", Needs::Mapping).1;
    let pressures = |recording: &Recording| -> Vec<f64> {
        let signal = recording.signal("p_ch").unwrap();
        signal
            .values_in(recording::Unit::BarGauge)
            .unwrap_or_else(|_| {
                signal
                    .values_at_ambient(recording::Unit::BarGauge, 101_325.0)
                    .unwrap()
            })
    };
    for &(name, needs, rows, missing, start) in LOGS {
        let (_, recording) = read(name, needs);
        let base = recording.time_base_of("p_ch").unwrap();
        assert_eq!(base.len(), rows, "{name}");
        let end_s = base.end_s() - base.start_s();
        let expected_s = if name == "several-rates.mf4" {
            0.788
        } else {
            0.01 * (rows - 1) as f64
        };
        assert!((end_s - expected_s).abs() < 1e-6, "{name}: {end_s} s");
        let found = recording.provenance().start.map(|start| start.to_string());
        assert_eq!(found.as_deref(), start, "{name}");
        let pressure = pressures(&recording);
        assert_eq!(
            pressure.iter().filter(|one| one.is_nan()).count(),
            missing,
            "{name}"
        );
        if name == "several-rates.mf4" {
            let valves = recording.time_base_of("duty_fill").unwrap();
            assert_eq!(valves.len(), 80, "each channel keeps its own instants");
            continue;
        }
        for (one, other) in pressure.iter().zip(pressures(&reference)) {
            assert!(
                one.is_nan() || (one - other).abs() < 1e-5,
                "{name}: {one} and {other}"
            );
        }
        for (signal, full) in [("duty_fill", 60.0), ("duty_vent", 80.0)] {
            let duty = recording.signal(signal).unwrap();
            let duty = duty.values_in(recording::Unit::Percent).unwrap();
            let full = if matches!(
                name,
                "pwm-counts.csv" | "short-names.csv" | "state-of-both.csv"
            ) {
                100.0
            } else {
                full
            };
            assert_eq!(
                duty.iter().copied().fold(0.0, f64::max),
                full,
                "{name} {signal}"
            );
        }
    }
}

/// The whole-column formats come in like the others, from the fixtures that Python wrote.
#[test]
fn what_an_inspection_leaves_out_has_a_reason() {
    for &(name, needs, ..) in LOGS {
        let (inspection, _) = read(name, needs);
        for column in &inspection.columns {
            assert!(
                !column.reason.is_empty(),
                "{name}: {} has no reason",
                column.key
            );
        }
    }
}
