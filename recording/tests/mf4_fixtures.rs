//! Fixtures written by the Python package asammdf and some made by hand: the reader returns the same values as asammdf.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use recording::csv::Mapping;
use recording::mf4::{Limits, Mf4Error, Options, READER_NOTE, list, read};
use recording::{Clock, LogFormat, LogOptions, Quantity, Recording, StartTime, Unit};
use recording::{read_log, read_log_file};

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/mf4"))
}

fn bytes(name: &str) -> Vec<u8> {
    fs::read(folder().join(format!("{name}.mf4"))).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn read_fixture(name: &str) -> Recording {
    let bytes = bytes(name);
    read(name, Cursor::new(bytes), &Options::default())
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Channel as read by asammdf.
struct Expected {
    is_time: bool,
    name: String,
    unit: String,
    /// Values; `None` for a channel of texts.
    values: Option<Vec<Option<f64>>>,
}

fn expected(name: &str) -> Vec<Expected> {
    let text = fs::read_to_string(folder().join(format!("{name}.txt"))).unwrap();
    text.lines()
        .map(|line| {
            let fields: Vec<&str> = line.splitn(5, ';').collect();
            let [_, kind, name, unit, values] = fields[..] else {
                panic!("{line}");
            };
            let value = |word: &str| (word != "-").then(|| word.parse().unwrap());
            let values = (values != "text").then(|| values.split(' ').map(value).collect());
            Expected {
                is_time: kind == "time",
                name: name.to_owned(),
                unit: unit.to_owned(),
                values,
            }
        })
        .collect()
}

/// Checks that every channel with a unit is read bit for bit, and every other one is left out with a reason.
fn check(fixture: &str, left_out: &[&str]) {
    let recording = read_fixture(fixture);
    let bits = |value: Option<f64>| value.map(f64::to_bits);
    let mut times = Vec::new();
    let mut checked = 0;
    for expected in expected(fixture) {
        let name = &expected.name;
        if expected.is_time {
            let unit = Unit::parse(&expected.unit).unwrap();
            let second = |value: Option<f64>| unit.convert(value.unwrap(), Unit::Second).unwrap();
            times = expected.values.unwrap().into_iter().map(second).collect();
            continue;
        }
        if left_out.contains(&name.as_str()) {
            assert!(recording.signal(name).is_none(), "{fixture} {name}");
            assert!(
                recording.reason_left_out(name).is_some(),
                "{fixture} {name}"
            );
            continue;
        }
        let signal = recording
            .signal(name)
            .unwrap_or_else(|| panic!("{fixture} {name}: {:?}", recording.left_out()));
        assert_eq!(Unit::parse(&expected.unit), Some(signal.unit()), "{name}");
        let values = expected.values.unwrap();
        assert!(
            signal.iter().map(bits).eq(values.into_iter().map(bits)),
            "{fixture} {name}: {:?}",
            signal.values_or_nan()
        );
        assert_eq!(
            recording.time_base_of(name).unwrap().times_s(),
            times,
            "{name}"
        );
        checked += 1;
    }
    assert_eq!(checked, recording.signals().len(), "{fixture}");
    assert_eq!(left_out.len(), recording.left_out().len(), "{fixture}");
}

#[test]
fn every_number_is_the_one_that_asammdf_reads() {
    let not_signals = ["p_sup", "counter", "state"];
    for fixture in ["rates", "rates-packed", "rates-transposed", "rates-411"] {
        check(fixture, &not_signals);
    }
    check("conversions", &["formula"]);
    check("numbers", &[]);
    check("invalid", &[]);
    check("lists", &[]);
    check("unsorted", &["remark"]);
    check("unfinished", &[]);
    check("started", &[]);
    check("started-local", &[]);
}

/// Position of the start time in the fixtures (bytes): after the identification, and the header and six links of the
/// header block.
const START_AT: usize = 64 + 24 + 6 * 8;

#[test]
fn the_start_is_the_one_that_asammdf_wrote() {
    let start_of = |bytes: &[u8]| {
        let recording = read("started", Cursor::new(bytes), &Options::default()).unwrap();
        recording.provenance().start
    };
    let said = |bytes: &[u8]| start_of(bytes).map(|start| start.to_string());
    let started = bytes("started");
    let start = StartTime {
        since_1970_ns: 1_714_745_527_000_000_000,
        clock: Clock::Utc { ahead_min: 120 },
    };
    assert_eq!(start_of(&started), Some(start));
    let local = said(&bytes("started-local")).unwrap();
    assert_eq!(local, "2024-05-03 16:12:07 local time");
    assert_eq!(start_of(&bytes("unsorted")), None);
    // Zone, summer time and flags; a zone of a day or more is ignored.
    let with = |zone_min: i16, summer_min: i16, flags: u8| {
        let mut bytes = started.clone();
        bytes[START_AT + 8..START_AT + 10].copy_from_slice(&zone_min.to_le_bytes());
        bytes[START_AT + 10..START_AT + 12].copy_from_slice(&summer_min.to_le_bytes());
        bytes[START_AT + 12] = flags;
        said(&bytes).unwrap()
    };
    assert_eq!(with(60, 60, 2), "2024-05-03 16:12:07 UTC+02:00");
    assert_eq!(with(-300, 60, 2), "2024-05-03 10:12:07 UTC-04:00");
    assert_eq!(with(-300, 60, 0), "2024-05-03 14:12:07 UTC");
    assert_eq!(with(-300, 60, 3), "2024-05-03 14:12:07 local time");
    assert_eq!(with(1440, 0, 2), "2024-05-03 14:12:07 UTC");
    assert_eq!(with(i16::MIN, i16::MIN, 2), "2024-05-03 14:12:07 UTC");
}

fn read_mapped(name: &str, mapping: &str) -> Result<Recording, Mf4Error> {
    let options = Options {
        mapping: Mapping::parse("test.toml", mapping).unwrap(),
        ..Options::default()
    };
    read(name, Cursor::new(bytes(name)), &options)
}

#[test]
fn groups_of_two_rates_are_time_bases_of_one_recording() {
    let recording = read_fixture("rates");
    let lengths: Vec<usize> = recording.time_bases().map(|(_, base)| base.len()).collect();
    assert_eq!(lengths, [60, 12]);
    let base = |name: &str| recording.signal(name).unwrap().time_base();
    assert!(base("p_ch") == base("i_fill") && base("p_ch") != base("duty_fill"));
    assert_eq!(
        recording.provenance().producer.as_deref(),
        Some("asammdf 8.8.28")
    );
    let comment = &recording.provenance().notes[0];
    assert_eq!(comment.value, "leak test & <bench 3>");
    let input = recording.provenance().input.unwrap();
    assert_eq!(input.size_bytes, bytes("rates").len() as u64);
}

#[test]
fn who_asks_for_a_channel_that_was_left_out_reads_what_to_write() {
    let recording = read_fixture("rates");
    let error = recording.require("p_sup", Quantity::Pressure).unwrap_err();
    let said = error.to_string();
    assert!(
        said.contains("found \"bar\", expected gauge or absolute"),
        "{said}"
    );
    let line = r#"signal.p_sup = { column = "p_sup", unit = "bar_gauge" }"#;
    assert!(said.ends_with(line), "{said}");
    let mapped = read_mapped("rates", &format!("schema = 1\n{line}\n")).unwrap();
    assert_eq!(mapped.signal("p_sup").unwrap().get(11), Some(8.0));
    let reason = |name: &str| recording.reason_left_out(name).unwrap().to_owned();
    assert!(reason("counter").starts_with("it has no unit; say in a mapping: signal.counter"));
    assert_eq!(reason("state"), "its values differ in length, as texts do");
}

/// Notes of the reader: unfinished, texts, NaN.
#[test]
fn what_was_done_to_the_numbers_is_noted() {
    let noted = |name: &str| -> Vec<String> {
        let recording = read_fixture(name);
        let notes = recording.provenance().notes.iter();
        let notes = notes.filter(|note| note.key == READER_NOTE);
        notes.map(|note| note.value.clone()).collect()
    };
    let unfinished = noted("unfinished");
    assert_eq!(unfinished.len(), 2, "{unfinished:?}");
    assert!(
        unfinished[0].contains("did not close the file"),
        "{unfinished:?}"
    );
    assert!(unfinished[1].starts_with("5 bytes after the last whole record"));
    let texts = noted("conversions");
    let ends = texts.iter().map(|text| text.rsplit_once(": ").unwrap().1);
    let numbers = "it holds the numbers";
    let missing = "samples that are texts are missing";
    assert!(ends.eq([numbers, missing, numbers]), "{texts:?}");
    assert!(
        texts
            .iter()
            .all(|text| text.contains("texts for some of its numbers"))
    );
    assert!(noted("rates").is_empty());
}

#[test]
fn a_mapping_chooses_scales_cuts_and_completes() {
    let mapping = r#"
        schema = 1
        ignore = ["i_fill"]
        signal.p_vent = { column = "p_ch", unit = "kPa_abs", scale = 100, offset = 100 }
        signal.x_vent = { column = "1/x_fill", unit = "mm", scale = 0.001 }
        signal.steps = { column = "2/counter", unit = "count" }
        rows = { from_s = 0.0195, until_s = 0.045 }
    "#;
    let recording = read_mapped("rates", mapping).unwrap();
    assert!(recording.signal("i_fill").is_none() && recording.signal("p_ch").is_none());
    let x_vent = recording.signal("x_vent").unwrap();
    assert_eq!((x_vent.len(), x_vent.get(0)), (26, Some(-10.0 * 0.001)));
    let steps = recording.signal("steps").unwrap();
    assert_eq!(steps.values_or_nan(), [2.0, 3.0, 4.0]);
    assert_eq!(recording.time_base_of("steps").unwrap().start_s(), 0.02);
    let constant = "schema = 1\nconstant.duty_vent = { value = 0, unit = \"pct\" }\n";
    let completed = read_mapped("lists", constant).unwrap();
    assert_eq!(completed.signal("duty_vent").unwrap().len(), 400);
}

#[test]
fn a_mapping_that_does_not_fit_the_file_is_refused() {
    let check = |mapping: &str, code: &str| {
        let error = read_mapped("rates", &format!("schema = 1\n{mapping}\n")).unwrap_err();
        assert_eq!(error.code(), code, "{error}");
    };
    let signal = |column: &str| format!("signal.p = {{ column = {column}, unit = \"bar_gauge\" }}");
    check(&signal("3"), "E-MF4-MAPPED-NUMBER");
    check(&signal("\"P_CH\""), "E-MF4-MAPPED-CHANNEL");
    check(&signal("\"2/p_ch\""), "E-MF4-MAPPED-CHANNEL");
    check(&signal("\"time\""), "E-MF4-MAPPED-CHANNEL");
    check(&signal("\"state\""), "E-MF4-MAPPED-UNUSABLE");
    check(
        "time = { column = \"time\", unit = \"s\" }",
        "E-MF4-MAPPED-TIME",
    );
    check(
        "constant.p_ch = { value = 1, unit = \"bar_gauge\" }",
        "E-MF4-CONSTANT-LOGGED",
    );
    check(
        "constant.duty_vent = { value = 0, unit = \"pct\" }",
        "E-MF4-CONSTANT-TIME-BASE",
    );
    check("rows = { from_s = 100.0 }", "E-MF4-NO-ROW-KEPT");
    let scale = "signal.p_sup = { column = \"p_sup\", unit = \"bar_gauge\", scale = 100 }";
    check(scale, "E-MF4-SCALE");
}

#[test]
fn a_listing_has_every_channel_with_what_stands_in_its_way() {
    let listing = list("rates", Cursor::new(bytes("rates")), Limits::default()).unwrap();
    assert_eq!((listing.version, listing.is_unfinished), (410, false));
    let groups = listing.groups.iter();
    let shape: Vec<_> = groups
        .map(|group| (group.samples, group.channels.len()))
        .collect();
    assert_eq!(shape, [(60, 3), (12, 5)]);
    let channel = |group: usize, index: usize| &listing.groups[group].channels[index];
    assert_eq!(
        (channel(0, 0).name.as_str(), &channel(0, 0).obstacle),
        ("p_ch", &None)
    );
    assert_eq!(
        (channel(1, 2).name.as_str(), channel(1, 2).unit.as_str()),
        ("p_sup", "bar")
    );
    assert!(
        channel(1, 2)
            .obstacle
            .as_ref()
            .unwrap()
            .contains("gauge or absolute")
    );
    let unfinished = list("u", Cursor::new(bytes("unfinished")), Limits::default()).unwrap();
    assert!(unfinished.is_unfinished);
}

/// `p_ch` is in two groups: neither is taken without a mapping, which chooses one by the number of its group.
#[test]
fn one_name_in_two_groups_is_chosen_by_the_mapping() {
    let mut bytes = bytes("rates");
    let name = bytes
        .windows(6)
        .position(|text| text == b"u_bat\0")
        .unwrap();
    bytes[name..name + 6].copy_from_slice(b"p_ch\0\0");
    let read = |mapping: &str| {
        let options = Options {
            mapping: Mapping::parse("test.toml", mapping).unwrap(),
            ..Options::default()
        };
        read("twice", Cursor::new(&bytes), &options)
    };
    let both = read("schema = 1").unwrap();
    assert!(both.signal("p_ch").is_none());
    let reason = both.reason_left_out("p_ch").unwrap();
    assert!(
        reason.starts_with("groups 1, 2 have a channel of this name"),
        "{reason}"
    );
    let line = r#"signal.p_ch = { column = "1/p_ch", unit = "bar_gauge" }"#;
    assert!(reason.ends_with(line), "{reason}");
    let first = read(&format!("schema = 1\n{line}")).unwrap();
    assert_eq!(first.signal("p_ch").unwrap().len(), 60);
    let error = read("schema = 1\nsignal.p = { column = \"p_ch\", unit = \"V\" }").unwrap_err();
    assert_eq!(error.code(), "E-MF4-MAPPED-CHANNEL-TWICE", "{error}");
    assert!(
        error
            .to_string()
            .ends_with("write \"1/p_ch\" for the first of them"),
        "{error}"
    );
}

#[test]
fn a_mapping_brings_two_rates_to_the_instants_of_one() {
    let at = |name: &str| {
        let rows = format!("rows = {{ instants_of = \"{name}\" }}");
        let constant = "constant.duty_vent = { value = 0, unit = \"pct\" }";
        read_mapped("rates", &format!("schema = 1\n{rows}\n{constant}\n"))
    };
    let slow = at("duty_fill").unwrap();
    assert_eq!(slow.time_bases().count(), 1);
    let all = read_fixture("rates");
    let fast = all.signal("p_ch").unwrap().values_or_nan();
    // The last of samples up to 59 ms is still known at 60 ms; none is known at 70 ms.
    let picked = slow.signal("p_ch").unwrap();
    let known: Vec<f64> = picked.iter().map_while(|value| value).collect();
    let places = [0, 10, 20, 30, 40, 50, 59];
    let expected: Vec<f64> = places.map(|place| fast[place]).to_vec();
    assert_eq!((known, picked.len()), (expected, 12));
    assert_eq!(slow.signal("duty_vent").unwrap().len(), 12);
    let note = slow.provenance().notes.last().unwrap();
    assert!(note.key == READER_NOTE && note.value.ends_with("the instants of \"duty_fill\""));
    assert_eq!(at("i_vent").unwrap_err().code(), "E-MF4-NO-INSTANTS");
}

/// A log is recognised by its first bytes and not by its name, also where it cannot be read twice.
#[test]
fn a_log_of_either_format_is_known_by_its_beginning() {
    let csv = b"time_s,p_ch_bar_gauge\n0.0,1.5\n0.1,1.6\n";
    let folder = tempfile::tempdir().unwrap();
    for (content, signals) in [
        (csv.to_vec(), 1),
        (bytes("rates"), 5),
        (bytes("unfinished"), 1),
    ] {
        let path = folder.path().join("log");
        fs::write(&path, &content).unwrap();
        let options = LogOptions::default();
        let of_file = read_log_file(&path, &options).unwrap();
        let of_stream = read_log("log", content.as_slice(), &options).unwrap();
        assert_eq!(of_file.signals().len(), signals);
        assert_eq!(of_stream, of_file);
    }
    let code = |content: &[u8]| {
        let error = read_log("log", content, &LogOptions::default()).unwrap_err();
        error.code()
    };
    assert_eq!(code(b""), "E-CSV-EMPTY");
    assert_eq!(code(b"MDF     4.10"), "E-MF4-ID");
    assert_eq!(code(b"UnFinMF 4.10"), "E-MF4-ID");
    let mf4_limits = Limits {
        file_bytes: 1000,
        ..Limits::default()
    };
    let options = LogOptions {
        mf4_limits,
        ..LogOptions::default()
    };
    let error = read_log("log", bytes("rates").as_slice(), &options).unwrap_err();
    assert_eq!(error.code(), "E-MF4-LIMIT-FILE", "{error}");
    let named = ["a.mf4", "a.MF4", "a.csv", "mf4"].map(LogFormat::of_name);
    let [mf4, csv] = [LogFormat::Mf4, LogFormat::Csv];
    assert_eq!(named, [mf4, mf4, csv, csv]);
}
