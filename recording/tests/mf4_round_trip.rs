//! MF4 round trip: written files are read back bit for bit, by the reader of this crate and by the Python package
//! asammdf.

use std::io::Cursor;
use std::process::Command;

use proptest::prelude::*;
use recording::csv::{Column, WriteError};
use recording::mf4::{Options, Writer, read, write};
use recording::{Bounds, Clock, InputFile, Provenance, Recording, StartTime, TimeBase, Unit};

fn read_back(bytes: &[u8]) -> Recording {
    read("back.mf4", Cursor::new(bytes), &Options::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

fn bits(values: &[f64]) -> Vec<Option<u64>> {
    let number = |value: &f64| (!value.is_nan()).then_some(value.to_bits());
    values.iter().map(number).collect()
}

fn assert_same(recording: &Recording, back: &Recording) {
    assert_eq!(recording.signals().len(), back.signals().len());
    assert!(back.left_out().is_empty(), "{:?}", back.left_out());
    for signal in recording.signals() {
        let name = signal.name();
        let again = back
            .signal(name)
            .unwrap_or_else(|| panic!("{name} is gone"));
        assert_eq!(again.unit(), signal.unit(), "{name}");
        assert_eq!(
            bits(again.values_or_nan()),
            bits(signal.values_or_nan()),
            "{name}"
        );
        let times = |recording: &Recording| bits(recording.time_base_of(name).unwrap().times_s());
        assert_eq!(times(back), times(recording), "{name}");
    }
}

/// Units whose values are limited only by the hard bounds of their quantity.
const FREE_UNITS: [Unit; 6] = [
    Unit::Milliampere,
    Unit::Volt,
    Unit::BarDifference,
    Unit::DegreeCelsius,
    Unit::Count,
    Unit::Fraction,
];

fn any_finite() -> impl Strategy<Value = f64> {
    any::<u64>()
        .prop_map(f64::from_bits)
        .prop_filter("finite", |value| value.is_finite())
}

/// Returns a possible value in `unit`: any bits within the bounds of its quantity.
fn within_bounds(value: f64, unit: Unit) -> f64 {
    let bounds = Bounds::of(unit.quantity()).in_unit(unit);
    match bounds.contains(&value) {
        true => value,
        false => value % 200.0,
    }
}

fn any_name() -> impl Strategy<Value = String> {
    "[a-z=+@'#<&\\-][a-zA-Z0-9_ ,;\"<>&/\\\\\\[\\]()µ]{0,20}[a-z)\\]\"]"
}

/// Generates one to three time bases, each with some signals.
fn any_recording() -> impl Strategy<Value = Recording> {
    let base = prop::collection::btree_set(any::<i32>(), 1..30).prop_flat_map(|ticks| {
        let sample = prop::option::weighted(0.9, any_finite());
        let samples = prop::collection::vec(sample, ticks.len());
        let signals = prop::collection::vec((any_name(), 0..FREE_UNITS.len(), samples), 1..4);
        (Just(ticks), signals)
    });
    prop::collection::vec(base, 1..4).prop_map(|bases| {
        let mut recording = Recording::new(Provenance::from_source("proptest"));
        for (ticks, signals) in bases {
            let times_s = ticks.iter().map(|&tick| f64::from(tick) * 1e-3).collect();
            let base = recording.add_time_base(TimeBase::new(times_s).unwrap());
            for (name, unit, samples) in signals {
                let sample = |sample: Option<f64>| {
                    within_bounds(sample.unwrap_or(f64::NAN), FREE_UNITS[unit])
                };
                let samples = samples.into_iter().map(sample).collect();
                // A name that is already taken gives one signal less.
                let _ = recording.add_signal(name, FREE_UNITS[unit], base, samples);
            }
        }
        recording
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_value_within_bounds_name_and_gap_survives(recording in any_recording()) {
        let written = write(Vec::new(), &recording).unwrap();
        assert_same(&recording, &read_back(&written));
    }
}

fn bench_recording() -> Recording {
    let mut provenance = Provenance::from_source("bench 3 <left> & right");
    provenance.producer = Some("plant-sim 0.1.0".to_owned());
    provenance.input = Some(InputFile {
        size_bytes: 3,
        sha256: [0xab; 32],
    });
    let mut recording = Recording::new(provenance.with_note("oil", "cold & \"thick\""));
    let fast = recording.add_time_base(TimeBase::uniform(0.0, 0.001, 50).unwrap());
    let slow = recording.add_time_base(TimeBase::uniform(0.0, 0.01, 5).unwrap());
    let wave =
        |amplitude: f64| (0..50).map(move |index| amplitude * (1.0 + f64::from(index).sin()));
    let mut pressure: Vec<f64> = wave(1.5).collect();
    pressure[7] = f64::NAN;
    recording
        .add_signal("p_ch", Unit::BarGauge, fast, pressure)
        .unwrap();
    let current = wave(300.0).collect();
    recording
        .add_signal("i_fill", Unit::Microampere, fast, current)
        .unwrap();
    let duty = vec![0.0, 28.5, 100.0, 5e-324, 0.1];
    recording
        .add_signal("duty_fill", Unit::Percent, slow, duty)
        .unwrap();
    recording
}

#[test]
fn provenance_goes_with_the_samples() {
    let recording = bench_recording();
    let back = read_back(&write(Vec::new(), &recording).unwrap());
    let provenance = back.provenance();
    assert_eq!(provenance.producer.as_deref(), Some("plant-sim 0.1.0"));
    let notes: Vec<_> = provenance
        .notes
        .iter()
        .map(|note| (note.key.as_str(), note.value.as_str()))
        .collect();
    let sha256 = "ab".repeat(32);
    let nan = "\"p_ch\" has 1 samples that are NaN: they count as missing";
    assert_eq!(
        notes,
        [
            ("source", "bench 3 <left> & right"),
            ("source sha256", sha256.as_str()),
            ("oil", "cold & \"thick\""),
            ("reader", nan),
        ]
    );
}

#[test]
fn the_start_goes_with_the_samples_where_it_is_known() {
    let mut recording = bench_recording();
    let without = write(Vec::new(), &recording).unwrap();
    assert_eq!(read_back(&without).provenance().start, None);
    let clocks = [
        Clock::Local,
        Clock::Utc { ahead_min: 0 },
        Clock::Utc { ahead_min: -210 },
    ];
    for clock in clocks {
        let start = Some(StartTime {
            since_1970_ns: 1_714_745_527_250_000_001,
            clock,
        });
        recording.provenance_mut().start = start;
        let written = write(Vec::new(), &recording).unwrap();
        assert_eq!(read_back(&written).provenance().start, start);
        assert_eq!(written.len(), without.len());
    }
}

/// Row by row, the number of rows is known only at the end: the bytes are the same.
#[test]
fn row_by_row_gives_the_bytes_of_the_whole() {
    let mut recording = Recording::new(Provenance::from_source("bench"));
    let base = recording.add_time_base(TimeBase::uniform(0.0, 0.01, 3).unwrap());
    recording
        .add_signal("u_bat", Unit::Volt, base, vec![24.0, f64::NAN, 23.5])
        .unwrap();
    let columns = [Column {
        name: "u_bat".to_owned(),
        unit: Unit::Volt,
    }];
    let sink = Cursor::new(Vec::new());
    let mut writer = Writer::new(sink, recording.provenance(), &columns).unwrap();
    for (time_s, value) in [(0.0, 24.0), (0.01, f64::NAN), (0.02, 23.5)] {
        writer.write_row(time_s, &[value]).unwrap();
    }
    let written = writer.finish().unwrap().into_inner();
    assert_eq!(written, write(Vec::new(), &recording).unwrap());
    assert_same(&recording, &read_back(&written));
}

#[test]
fn rows_that_no_reader_would_take_are_not_written() {
    let column = |name: &str| Column {
        name: name.to_owned(),
        unit: Unit::Volt,
    };
    let provenance = Provenance::from_source("bench");
    let begin = |names: &[&str]| {
        let columns: Vec<Column> = names.iter().map(|name| column(name)).collect();
        Writer::new(Cursor::new(Vec::new()), &provenance, &columns)
    };
    assert!(matches!(begin(&[]).err(), Some(WriteError::NoColumns)));
    assert!(matches!(
        begin(&["u", "u"]).err(),
        Some(WriteError::NameTaken { .. })
    ));
    assert!(matches!(begin(&[""]).err(), Some(WriteError::Name { .. })));
    assert!(matches!(
        begin(&["u"]).unwrap().finish().err(),
        Some(WriteError::NoRows)
    ));
    let mut writer = begin(&["u"]).unwrap();
    writer.write_row(1.0, &[0.0]).unwrap();
    let mut refusal = |time_s, values: &[f64]| writer.write_row(time_s, values).unwrap_err();
    assert!(matches!(
        refusal(1.0, &[0.0]),
        WriteError::TimeOrder { row: 1, .. }
    ));
    assert!(matches!(
        refusal(f64::NAN, &[0.0]),
        WriteError::TimeOrder { .. }
    ));
    assert!(matches!(
        refusal(2.0, &[f64::INFINITY]),
        WriteError::Infinite { .. }
    ));
    assert!(matches!(
        refusal(2.0, &[]),
        WriteError::ValueCount { found: 0, .. }
    ));
    let without = Recording::new(Provenance::from_source("bench"));
    assert!(matches!(
        write(Vec::new(), &without),
        Err(WriteError::NoColumns)
    ));
}

/// Uses the Python package, if it is installed: the interpreter in `ASAMMDF_PYTHON`, or `python3`.
#[test]
fn asammdf_reads_what_we_write_bit_for_bit() {
    let python = std::env::var("ASAMMDF_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has_package = Command::new(&python)
        .args(["-c", "import asammdf"])
        .output()
        .is_ok_and(|output| output.status.success());
    if !has_package {
        eprintln!("skipped: {python} has no package asammdf; pip install asammdf==8.8.28");
        return;
    }
    let recording = bench_recording();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ours.mf4");
    std::fs::write(&path, write(Vec::new(), &recording).unwrap()).unwrap();
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/fixtures/mf4/describe.py"
    );
    let output = Command::new(&python)
        .arg(script)
        .arg(&path)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let described = String::from_utf8(output.stdout).unwrap();
    let mut seen = 0;
    for line in described.lines() {
        let fields: Vec<&str> = line.splitn(5, ';').collect();
        let [_, kind, name, unit, values] = fields[..] else {
            panic!("{line}");
        };
        if kind == "time" {
            continue;
        }
        let signal = recording.signal(name).unwrap();
        let values: Vec<f64> = values
            .split(' ')
            .map(|word| word.parse().unwrap())
            .collect();
        assert_eq!(bits(&values), bits(signal.values_or_nan()), "{name}");
        assert_eq!(Unit::parse(unit), Some(signal.unit()), "{name}");
        seen += 1;
    }
    assert_eq!(seen, recording.signals().len(), "{described}");
}
