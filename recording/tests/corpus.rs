//! Small hand-made files, each with one error or with one unusual but valid property.

#[allow(dead_code, reason = "each test checks some of the properties")]
mod properties;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use recording::csv::{CsvError, Mapping, Options, read};

/// File, code, and line of the problem if it has one.
#[rustfmt::skip]
const WRONG: &[(&str, &str, Option<u64>)] = &[
    ("both-separators.csv", "E-CSV-THOUSANDS", Some(2)),
    ("carriage-return-within.csv", "E-CSV-LINE-END", Some(2)),
    ("columns-4097.csv", "E-CSV-LIMIT-COLUMNS", Some(1)),
    ("current-out-of-bounds.csv", "E-CSV-BOUNDS", Some(3)),
    ("decimal-ambiguous-beside-point.csv", "E-CSV-DECIMAL-AMBIGUOUS", Some(2)),
    ("decimal-ambiguous.csv", "E-CSV-DECIMAL-AMBIGUOUS", Some(2)),
    ("decimal-comma-between-commas.csv", "E-CSV-RAGGED", Some(2)),
    ("decimal-mixed.csv", "E-CSV-DECIMAL-MIXED", Some(3)),
    ("duty-above-100.csv", "E-CSV-DUTY-RANGE", Some(3)),
    ("duty-below-0.csv", "E-CSV-DUTY-RANGE", Some(2)),
    ("duty-fraction-above-1.csv", "E-CSV-DUTY-RANGE", Some(2)),
    ("duty-fraction-as-percent.csv", "E-CSV-SCALE", Some(4)),
    ("empty.csv", "E-CSV-EMPTY", None),
    ("escape-in-name.csv", "E-CSV-NAME", Some(1)),
    ("field-65537-bytes.csv", "E-CSV-LIMIT-FIELD", Some(2)),
    ("hexadecimal.csv", "E-CSV-NUMBER", Some(2)),
    ("infinite.csv", "E-CSV-NOT-FINITE", Some(2)),
    ("name-of-257-bytes.csv", "E-CSV-NAME", Some(1)),
    ("nameless-column.csv", "E-CSV-NAME", Some(1)),
    ("nan.csv", "E-CSV-NOT-FINITE", Some(3)),
    ("no-header.csv", "E-CSV-HEADER", Some(1)),
    ("no-rows.csv", "E-CSV-NO-DATA", None),
    ("no-signal.csv", "E-CSV-NO-SIGNAL", Some(1)),
    ("no-time-column.csv", "E-CSV-TIME-NO-COLUMN", Some(1)),
    ("one-column.csv", "E-CSV-DELIMITER", Some(1)),
    ("only-comments.csv", "E-CSV-EMPTY", None),
    ("overflow.csv", "E-CSV-NOT-FINITE", Some(2)),
    ("pressure-bar-as-kPa.csv", "E-CSV-SCALE", Some(3)),
    ("pressure-below-vacuum.csv", "E-CSV-BELOW-VACUUM", Some(3)),
    ("pressure-gauge-as-absolute.csv", "E-CSV-SCALE", Some(3)),
    ("pressure-kPa-as-bar.csv", "E-CSV-SCALE", Some(4)),
    ("pressure-without-reference.csv", "E-CSV-PRESSURE-REFERENCE", Some(1)),
    ("quote-in-number.csv", "E-CSV-NUMBER", Some(2)),
    ("quote-not-closed.csv", "E-CSV-TRUNCATED", Some(2)),
    ("ragged-long.csv", "E-CSV-RAGGED", Some(3)),
    ("ragged-short.csv", "E-CSV-RAGGED", Some(3)),
    ("text-after-unit-columns.csv", "E-CSV-NUMBER", Some(4)),
    ("text-in-number.csv", "E-CSV-NUMBER", Some(3)),
    ("thousands.csv", "E-CSV-THOUSANDS", Some(3)),
    ("time-backwards.csv", "E-CSV-TIME-ORDER", Some(4)),
    ("time-counter-runs-over.csv", "E-CSV-TIME-ORDER", Some(4)),
    ("time-missing.csv", "E-CSV-TIME-MISSING", Some(3)),
    ("time-out-of-bounds.csv", "E-CSV-TIME-BOUNDS", Some(3)),
    ("time-repeats.csv", "E-CSV-TIME-ORDER", Some(4)),
    ("time-scale.csv", "E-CSV-TIME-SCALE", Some(5)),
    ("trailing-garbage-column.csv", "E-CSV-UNMAPPED", Some(3)),
    ("truncated-at-separator.csv", "E-CSV-TRUNCATED", Some(3)),
    ("truncated-integer.csv", "E-CSV-TRUNCATED", Some(3)),
    ("truncated-number.csv", "E-CSV-TRUNCATED", Some(3)),
    ("truncated-row.csv", "E-CSV-TRUNCATED", Some(3)),
    ("two-signals-one-name.csv", "E-CSV-NAME-DUPLICATE", Some(1)),
    ("two-time-columns.csv", "E-CSV-TIME-TWO-COLUMNS", Some(1)),
    ("unit-in-number.csv", "E-CSV-NUMBER", Some(2)),
    ("unit-missing.csv", "E-CSV-UNIT-MISSING", Some(1)),
    ("unit-unknown.csv", "E-CSV-UNIT-UNKNOWN", Some(1)),
    ("unit-wrong-case.csv", "E-CSV-UNIT-UNKNOWN", Some(1)),
    ("units-row-conflict.csv", "E-CSV-UNIT-CONFLICT", Some(1)),
    ("units-row-unknown.csv", "E-CSV-UNIT-UNKNOWN", Some(1)),
    ("zero-byte.csv", "E-CSV-ENCODING", None),
    ("zip.csv", "E-CSV-ENCODING", None),
];

#[rustfmt::skip]
const WRONG_MAPPINGS: &[(&str, &str, Option<usize>)] = &[
    ("column-negative.toml", "E-MAP-TOML", Some(3)),
    ("column-zero.toml", "E-MAP-COLUMN", Some(3)),
    ("constant-duty.toml", "E-MAP-CONSTANT", Some(3)),
    ("constant-time.toml", "E-MAP-TIME-SIGNAL", Some(2)),
    ("delimiter-unknown.toml", "E-MAP-CHOICE", Some(3)),
    ("name-empty.toml", "E-MAP-NAME", Some(2)),
    ("nested-deep.toml", "E-MAP-TOML", None),
    ("not-toml.toml", "E-MAP-TOML", Some(2)),
    ("offset-nan.toml", "E-MAP-FACTOR", Some(5)),
    ("pressure-without-reference.toml", "E-MAP-UNIT", Some(4)),
    ("plausible-time.toml", "E-MAP-TIME-RANGE", Some(5)),
    ("plausible-turned.toml", "E-MAP-RANGE", Some(5)),
    ("rows-nan.toml", "E-MAP-FACTOR", Some(3)),
    ("rows-none.toml", "E-MAP-ROWS", Some(4)),
    ("scale-zero.toml", "E-MAP-FACTOR", Some(5)),
    ("schema-missing.toml", "E-MAP-TOML", None),
    ("schema-newer.toml", "E-MAP-SCHEMA", Some(1)),
    ("thousands-as-decimal.toml", "E-MAP-THOUSANDS", Some(7)),
    ("time-as-signal.toml", "E-MAP-TIME-SIGNAL", Some(2)),
    ("time-in-bar.toml", "E-MAP-TIME-UNIT", Some(4)),
    ("unit-missing.toml", "E-MAP-TOML", Some(2)),
    ("unit-unknown.toml", "E-MAP-UNIT", Some(4)),
    ("unknown-column-key.toml", "E-MAP-TOML", Some(5)),
    ("unknown-key.toml", "E-MAP-TOML", Some(3)),
];

/// Mappings that once caused a panic or excessive memory with a good log, and the code with which they are refused;
/// `None` if less than half of the cells are out of bounds.
const OUT_OF_BOUNDS: [(&str, Option<&str>); 4] = [
    ("offset-1e9.toml", Some("E-CSV-BOUNDS")),
    ("offset-2-to-the-32.toml", Some("E-CSV-BOUNDS")),
    ("offset-2-to-the-63.toml", Some("E-CSV-BOUNDS")),
    ("scale-1000.toml", None),
];

fn corpus(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/corpus")
        .join(folder)
}

fn names(folder: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(corpus(folder)).expect("the corpus is there");
    entries
        .map(|entry| {
            entry
                .expect("the folder can be listed")
                .file_name()
                .into_string()
                .unwrap()
        })
        .collect()
}

fn refusal(name: &str) -> CsvError {
    let bytes = fs::read(corpus("wrong").join(name)).expect("the file is there");
    match read(name, bytes.as_slice(), &Options::default()) {
        Err(error) => error,
        Ok(_) => panic!("{name} was accepted"),
    }
}

#[test]
fn each_wrong_file_is_refused_with_its_code_and_line() {
    let listed: BTreeSet<_> = WRONG.iter().map(|(name, ..)| (*name).to_owned()).collect();
    assert_eq!(
        listed,
        names("wrong"),
        "the table and the folder name the same files"
    );
    let mut failures = Vec::new();
    for &(name, code, line) in WRONG {
        let error = refusal(name);
        if (error.code(), error.place().line) != (code, line) {
            failures.push(format!("expected {code} at line {line:?}, got {error}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The text is one line for a terminal: code, file, found value, expected value, and a next step.
#[test]
fn each_refusal_is_one_printable_line_that_names_the_file_and_a_next_step() {
    for &(name, code, _) in WRONG {
        let error = refusal(name);
        let text = error.to_string();
        assert!(text.starts_with(&format!("{code}: {name}")), "{text}");
        assert!(!text.contains(char::is_control), "{text:?}");
        assert!(text.len() < 600, "{text}");
        assert!(text.ends_with(&error.problem().next_step()), "{text}");
    }
}

#[test]
fn each_wrong_mapping_is_refused_with_its_code_and_line() {
    let listed: BTreeSet<_> = WRONG_MAPPINGS
        .iter()
        .map(|(name, ..)| (*name).to_owned())
        .collect();
    assert_eq!(
        listed,
        names("mapping-wrong"),
        "the table and the folder name the same files"
    );
    for &(name, code, line) in WRONG_MAPPINGS {
        let text = fs::read_to_string(corpus("mapping-wrong").join(name)).unwrap();
        let error = Mapping::parse(name, &text).expect_err(name);
        assert_eq!(error.code(), code, "{error}");
        if let Some(line) = line {
            assert_eq!(error.place().map(|(line, _)| line), Some(line), "{error}");
        }
        assert!(!error.to_string().contains(char::is_control), "{error}");
    }
    for name in names("mapping-good") {
        let text = fs::read_to_string(corpus("mapping-good").join(&name)).unwrap();
        Mapping::parse(&name, &text).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn mappings_that_lead_out_of_bounds_are_refused_or_leave_the_cells_out() {
    let folder = corpus("out-of-bounds");
    let log = fs::read(folder.join("log.csv")).unwrap();
    for (name, code) in OUT_OF_BOUNDS {
        let mapping = Mapping::read_file(folder.join(name)).unwrap();
        let options = Options {
            mapping,
            ..Options::default()
        };
        match read("log.csv", log.as_slice(), &options) {
            Err(error) => {
                assert_eq!(Some(error.code()), code, "{name}: {error}");
                assert_eq!(error.place().column, Some(4), "{name}: {error}");
            }
            Ok(recording) => {
                let [cells] = recording.out_of_bounds() else {
                    panic!("{name}: {:?}", recording.out_of_bounds());
                };
                assert_eq!(
                    (code, cells.count, cells.column),
                    (None, 45, Some(4)),
                    "{name}"
                );
            }
        }
    }
}

/// All files contain the same three samples in different dialects.
#[test]
fn every_odd_dialect_gives_the_same_recording() {
    let names = names("good");
    assert_eq!(names.len(), 20);
    for name in names {
        let bytes = fs::read(corpus("good").join(&name)).unwrap();
        let recording = read(&name, bytes.as_slice(), &Options::default())
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            recording.time_base_of("p_ch").expect(&name).times_s(),
            [0.0, 0.01, 0.02],
            "{name}"
        );
        let pressure = recording.signal("p_ch").expect(&name);
        assert_eq!(pressure.unit(), recording::Unit::BarGauge, "{name}");
        assert_eq!(pressure.values_or_nan(), [1.5, 1.6, -0.25], "{name}");
        assert_eq!(recording.signals().len(), 1, "{name}");
    }
}

/// The seeds of the fuzz targets meet the requirements that the targets test.
#[test]
fn the_seeds_of_the_fuzzer_have_its_properties() {
    let files = |folder: &'static str| {
        names(folder)
            .into_iter()
            .map(move |name| fs::read(corpus(folder).join(name)).unwrap())
    };
    files("wrong")
        .chain(files("good"))
        .for_each(|bytes| properties::csv_reader(&bytes));
    for bytes in files("mapping-wrong").chain(files("mapping-good")) {
        properties::mapping_toml(&String::from_utf8(bytes).unwrap());
    }
}
