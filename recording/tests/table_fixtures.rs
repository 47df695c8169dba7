//! Parquet and MATLAB files that Python wrote, read bit for bit, and what is left out of them.

#[allow(dead_code, reason = "each test checks some of the properties")]
mod properties;

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use recording::csv::{self, Mapping};
use recording::table::{write_matlab, write_matlab_hdf5, write_parquet};
use recording::{
    LogError, LogFormat, LogOptions, Recording, inspect_file, read_log, read_log_file,
};

const FILES: [&str; 9] = [
    "pandas-snappy.parquet",
    "pyarrow-zstd-pages.parquet",
    "pyarrow-plain.parquet",
    "pyarrow-timestamps.parquet",
    "scipy-v6.mat",
    "scipy-v7.mat",
    "scipy-simulink.mat",
    "hdf5storage-v7.3.mat",
    "h5py.h5",
];

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures/table")
        .join(name)
}

fn options(mapping: &str) -> LogOptions {
    LogOptions {
        mapping: Mapping::parse("mapping", mapping).unwrap(),
        ..LogOptions::default()
    }
}

fn bits(values: &[f64]) -> Vec<String> {
    let shown = |value: &f64| match value.is_nan() {
        true => "nan".to_owned(),
        false => format!("{:016x}", value.to_bits()),
    };
    values.iter().map(shown).collect()
}

/// Every column of every file, as a signal without a unit.
#[test]
fn every_number_is_that_of_python_bit_for_bit() {
    let expected = fs::read_to_string(fixture("read-by-python.txt")).unwrap();
    let mut compared = Vec::new();
    for line in expected.lines() {
        let mut parts = line.split('\t');
        let (name, column) = (parts.next().unwrap(), parts.next().unwrap());
        let numbers: Vec<&str> = parts.next().unwrap().split(' ').collect();
        let time = if name.contains("timestamps") {
            "timestamp"
        } else {
            "time_s"
        };
        let is_time = column == time;
        let signal = if is_time { "p_ch_bar_gauge" } else { column };
        let mapping = format!(
            "schema = 1\n[time]\ncolumn = \"{time}\"\nunit = \"s\"\n[signal.x]\ncolumn = \"{signal}\"\nunit = \"count\"\n"
        );
        let recording = read_log_file(fixture(name), &options(&mapping))
            .unwrap_or_else(|error| panic!("{name} {column}: {error}"));
        let values = match is_time {
            true => recording.time_base_of("x").unwrap().times_s(),
            false => recording.signal("x").unwrap().values_or_nan(),
        };
        assert_eq!(bits(values), numbers, "{name} {column}");
        compared.push(name.to_owned());
    }
    assert_eq!(compared.len(), 56);
    assert!(
        FILES
            .iter()
            .all(|name| compared.iter().any(|one| one == name))
    );
}

#[test]
fn a_file_with_standard_names_needs_no_mapping_and_says_what_it_left_out() {
    let left_out = |name: &str| {
        let recording = read_log_file(fixture(name), &LogOptions::default())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let signals = recording.signals().iter();
        let signals: Vec<&str> = signals.map(|signal| signal.name()).collect();
        for wanted in ["p_ch", "duty_fill", "duty_vent"] {
            assert!(signals.contains(&wanted), "{name}: {signals:?}");
        }
        assert!(recording.provenance().input.is_some());
        let left_out = recording.left_out().iter();
        left_out
            .map(|one| format!("{}: {}", one.name, one.reason))
            .collect::<Vec<_>>()
    };
    assert_eq!(left_out("pandas-snappy.parquet"), ["remark: texts"]);
    let nested = left_out("pyarrow-zstd-pages.parquet");
    assert!(
        nested.contains(&"a: a nested column".to_owned()),
        "{nested:?}"
    );
    for name in ["scipy-v6.mat", "scipy-v7.mat"] {
        let said = left_out(name);
        for wanted in [
            "gain: a single value",
            "remark: a text",
            "cells: a cell array",
            "complex_V: complex numbers",
        ] {
            assert!(said.contains(&wanted.to_owned()), "{name}: {said:?}");
        }
    }
    let said = left_out("hdf5storage-v7.3.mat");
    assert!(said.contains(&"remark: a text".to_owned()), "{said:?}");
    assert_eq!(left_out("h5py.h5"), ["remark: texts"]);
}

#[test]
fn dates_give_the_start_of_the_log() {
    let recording = read_log_file(
        fixture("pyarrow-timestamps.parquet"),
        &LogOptions::default(),
    )
    .unwrap();
    let start = recording.provenance().start.unwrap();
    assert_eq!(start.to_string(), "2026-11-23 13:05:06 UTC");
    assert_eq!(start.since_1970_ns % 1_000_000_000, 125_003_000);
    assert_eq!(
        recording.time_base_of("p_ch").unwrap().times_s()[..2],
        [0.0, 0.01]
    );
}

#[test]
fn an_inspection_of_each_format_proposes_a_mapping_or_needs_none() {
    for name in FILES {
        let inspection = inspect_file(fixture(name), &LogOptions::default(), None).unwrap();
        assert!(inspection.is_ready(), "{name}: {inspection:#?}");
        assert!(
            !inspection.layout.is_empty() && inspection.rows == 40,
            "{name}"
        );
    }
}

/// A file and a stream of it give the same recording.
#[test]
fn the_format_is_found_by_the_first_bytes_alone() {
    for name in FILES {
        let bytes = fs::read(fixture(name)).unwrap();
        let of_file = read_log_file(fixture(name), &LogOptions::default()).unwrap();
        let of_stream = read_log(name, bytes.as_slice(), &LogOptions::default()).unwrap();
        assert_eq!(of_file.provenance(), of_stream.provenance(), "{name}");
        for (one, other) in of_file.signals().iter().zip(of_stream.signals()) {
            let same = bits(one.values_or_nan()) == bits(other.values_or_nan());
            assert!(same && one.name() == other.name(), "{name}: {}", one.name());
        }
        assert_ne!(
            LogFormat::of_beginning(&bytes[..128]),
            LogFormat::Csv,
            "{name}"
        );
    }
}

fn practice() -> Recording {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/synthetic/practice-01-id.csv");
    let text = fs::read_to_string(path).unwrap();
    // A missing pressure, which each format has to keep.
    let thin = |(number, line): (usize, &str)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if number == 20 {
            cells[3] = "";
        }
        cells.join(",") + "\n"
    };
    let text: String = text.lines().enumerate().map(thin).collect();
    csv::read("practice", text.as_bytes(), &csv::Options::default()).unwrap()
}

#[test]
fn what_is_written_is_read_back_bit_for_bit() {
    let recording = practice();
    assert_eq!(recording.signal("p_ch").unwrap().missing_count(), 1);
    let (base, times) = recording.time_bases().next().unwrap();
    let parquet = write_parquet(Vec::new(), &recording, base).unwrap();
    let matlab = write_matlab(Vec::new(), &recording, base).unwrap();
    let hdf5 = write_matlab_hdf5(Vec::new(), &recording, base).unwrap();
    for bytes in [parquet, matlab, hdf5] {
        let read = read_log("written", Cursor::new(&bytes), &LogOptions::default()).unwrap();
        assert_eq!(
            read.time_bases().next().unwrap().1.times_s(),
            times.times_s()
        );
        assert_eq!(read.signals().len(), recording.signals().len());
        for signal in recording.signals() {
            let again = read.signal(signal.name()).unwrap();
            assert_eq!(again.unit(), signal.unit());
            assert_eq!(
                bits(again.values_or_nan()),
                bits(signal.values_or_nan()),
                "{}",
                signal.name()
            );
        }
    }
}

/// Defect seen: a file that was to be written to `.h5` was CSV.
#[test]
fn the_name_of_a_file_tells_the_format_to_write() {
    for (name, format) in [
        ("model.csv", LogFormat::Csv),
        ("model.mf4", LogFormat::Mf4),
        ("model.parquet", LogFormat::Parquet),
        ("model.MAT", LogFormat::Matlab),
        ("model.h5", LogFormat::MatlabHdf5),
        ("model.hdf5", LogFormat::MatlabHdf5),
    ] {
        assert_eq!(LogFormat::of_name(name), format, "{name}");
    }
}

#[test]
fn a_mapping_error_names_the_column_and_the_next_step() {
    let refused = |mapping: &str| {
        let error = read_log_file(fixture("scipy-v7.mat"), &options(mapping)).unwrap_err();
        let text = error.to_string();
        assert!(
            !text.contains(char::is_control) && text.starts_with(error.code()),
            "{text}"
        );
        (error.code(), text)
    };
    let (code, text) =
        refused("schema = 1\n[signal.p_ch]\ncolumn = \"P1\"\nunit = \"bar_gauge\"\n");
    assert_eq!(code, "E-TAB-MAPPED-COLUMN");
    assert!(
        text.contains("names \"P1\"") && text.contains("p_ch_bar_gauge"),
        "{text}"
    );
    let (code, text) =
        refused("schema = 1\n[signal.p_ch]\ncolumn = \"remark\"\nunit = \"bar_gauge\"\n");
    assert_eq!(code, "E-TAB-NO-NUMBERS");
    assert!(
        text.contains("column \"remark\"") && text.contains("a text"),
        "{text}"
    );
    let (code, _) = refused("schema = 1\n[time]\ncolumn = \"duty_fill_pct\"\nunit = \"s\"\n");
    assert_eq!(code, "E-TAB-TIME");
    let (code, _) = refused("schema = 1\n[time]\ncolumn = \"time_s\"\nunit = \"clock\"\n");
    assert_eq!(code, "E-TAB-CLOCK");
    let (code, _) = refused("schema = 1\n[rows]\nfrom_s = 9\n");
    assert_eq!(code, "E-TAB-NO-ROW-KEPT");
}

#[test]
fn a_file_beyond_a_budget_is_refused_with_the_bound() {
    for name in FILES {
        let bytes = fs::read(fixture(name)).unwrap();
        let whole = LogOptions::default();
        for (budget, limits) in [
            (
                "bytes",
                recording::table::Limits {
                    file_bytes: 1000,
                    ..whole.table_limits
                },
            ),
            (
                "values",
                recording::table::Limits {
                    values: 50,
                    ..whole.table_limits
                },
            ),
            (
                "columns",
                recording::table::Limits {
                    columns: 2,
                    ..whole.table_limits
                },
            ),
        ] {
            let options = LogOptions {
                table_limits: limits,
                ..whole.clone()
            };
            let error = read_log(name, bytes.as_slice(), &options).unwrap_err();
            assert_eq!(error.code(), "E-TAB-LIMIT", "{name} {budget}: {error}");
            assert!(
                error.to_string().contains(budget),
                "{name} {budget}: {error}"
            );
        }
    }
}

/// Cut files are refused; a changed byte gives a recording or a refusal, in one line, and no panic of the readers.
#[test]
fn damaged_files_are_refused_with_a_reason() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let check = |name: &str, bytes: &[u8]| match read_log(name, bytes, &LogOptions::default()) {
        Ok(_) => true,
        Err(error) => {
            let text = error.to_string();
            assert!(
                !text.contains(char::is_control) && text.len() < 700,
                "{name}: {text}"
            );
            assert!(
                matches!(error, LogError::Table(_)) || !text.is_empty(),
                "{name}: {text}"
            );
            assert!(
                !text.contains("the place cannot be found"),
                "{name}: a panic was caught"
            );
            false
        }
    };
    for name in FILES {
        let bytes = fs::read(fixture(name)).unwrap();
        for length in (0..bytes.len()).step_by(1 + bytes.len() / 200) {
            let is_read = check(name, &bytes[..length]);
            // MATLAB v5 does not state how many variables follow: a cut between two of them cannot be noticed.
            let may_be_read = name.starts_with("scipy");
            assert!(!is_read || may_be_read, "{name} cut to {length} bytes");
        }
        for _ in 0..400 {
            let mut changed = bytes.clone();
            for _ in 0..1 + random() % 3 {
                let at = (random() % changed.len() as u64) as usize;
                changed[at] = random() as u8;
            }
            check(name, &changed);
            properties::table_reader(&changed);
        }
    }
}
