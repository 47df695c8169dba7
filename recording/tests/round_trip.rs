//! CSV round trip: the reader returns what the writer wrote, with the same bits, gaps, names and units.

use proptest::prelude::*;
use recording::csv::{Column, Decimals, Options, WriteError, Writer, read, write};
use recording::{Bounds, Clock, InputFile, Provenance, Recording, StartTime, TimeBase, Unit};

fn written(recording: &Recording, decimals: &Decimals) -> Vec<u8> {
    let (time_base, _) = recording.time_bases().next().expect("one time base");
    write(Vec::new(), recording, time_base, decimals).unwrap_or_else(|error| panic!("{error}"))
}

fn read_back(bytes: &[u8]) -> Recording {
    read("back.csv", bytes, &Options::default())
        .unwrap_or_else(|error| panic!("{error}\n{}", String::from_utf8_lossy(bytes)))
}

/// Units whose values are limited only by the hard bounds of their quantity.
const FREE_UNITS: [Unit; 5] = [
    Unit::Milliampere,
    Unit::Volt,
    Unit::BarDifference,
    Unit::DegreeCelsius,
    Unit::Count,
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
    "[a-z=+@'#\\-][a-zA-Z0-9_ ,;\"\\[\\]()µ]{0,20}[a-z)\\]\"]"
}

fn any_recording() -> impl Strategy<Value = Recording> {
    let names = prop::collection::btree_set(any_name(), 1..5);
    (names, prop::collection::btree_set(-9_000i32..9_000, 3..40)).prop_flat_map(|(names, ticks)| {
        let samples = prop::collection::vec(prop::option::weighted(0.9, any_finite()), ticks.len());
        let signals = prop::collection::vec((0..FREE_UNITS.len(), samples), names.len());
        (Just(names), Just(ticks), signals).prop_map(|(names, ticks, signals)| {
            let mut recording = Recording::new(Provenance::from_source("proptest"));
            let times_s = ticks.iter().map(|&tick| f64::from(tick) * 1e-3).collect();
            let base = recording.add_time_base(TimeBase::new(times_s).unwrap());
            for (name, (unit, samples)) in names.into_iter().zip(signals) {
                let samples = samples
                    .into_iter()
                    .map(|sample| sample.unwrap_or(f64::NAN))
                    .map(|sample| within_bounds(sample, FREE_UNITS[unit]))
                    .collect();
                recording
                    .add_signal(name, FREE_UNITS[unit], base, samples)
                    .unwrap();
            }
            recording
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_value_within_bounds_name_and_gap_survives(recording in any_recording()) {
        let back = read_back(&written(&recording, &Decimals::shortest()));
        prop_assert_eq!(back.signals().len(), recording.signals().len());
        for signal in recording.signals() {
            let again = back.signal(signal.name()).expect("the name survives");
            prop_assert_eq!(again.unit(), signal.unit());
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            let missing_alike = |values: &[f64]| {
                bits(&values.iter().map(|&value| if value.is_nan() { f64::NAN } else { value }).collect::<Vec<_>>())
            };
            prop_assert_eq!(missing_alike(again.values_or_nan()), missing_alike(signal.values_or_nan()));
        }
        let times = |recording: &Recording| recording.time_bases().next().unwrap().1.times_s().to_vec();
        prop_assert_eq!(times(&back), times(&recording));
    }
}

fn two_rows(name: &str, unit: Unit, values: [f64; 2]) -> Recording {
    let mut recording = Recording::new(Provenance::from_source("bench"));
    let base = recording.add_time_base(TimeBase::uniform(0.0, 0.01, 2).unwrap());
    recording
        .add_signal(name, unit, base, values.to_vec())
        .unwrap();
    recording
}

#[test]
fn a_file_of_ours_looks_like_this() {
    let mut recording = two_rows("p_ch", Unit::BarGauge, [1.5, f64::NAN]);
    let provenance = recording.provenance_mut();
    provenance.producer = Some("plant-sim 0.1.0".to_owned());
    provenance.input = Some(InputFile {
        size_bytes: 3,
        sha256: [0xab; 32],
    });
    provenance.start = Some(StartTime {
        since_1970_ns: 1_714_745_527_250_000_000,
        clock: Clock::Utc { ahead_min: 0 },
    });
    *provenance = provenance.clone().with_note("oil", "cold\n\u{1b}[31m");
    let text = String::from_utf8(written(&recording, &Decimals::shortest())).unwrap();
    let sha256 = "ab".repeat(32);
    let expected = format!(
        "# source: bench\n# producer: plant-sim 0.1.0\n# recorded: 2024-05-03 14:12:07 UTC\n\
         # source sha256: {sha256}\n# oil: cold  [31m\ntime_s,p_ch_bar_gauge\n0,1.5\n0.01,\n"
    );
    assert_eq!(text, expected);
    let back = read_back(text.as_bytes());
    assert_eq!(
        back.provenance().producer.as_deref(),
        Some("plant-sim 0.1.0")
    );
    assert_eq!(back.provenance().notes.len(), 4);
    assert_eq!(back.signal("p_ch").unwrap().get(1), None);
}

#[test]
fn chosen_decimals_hold_for_their_unit_only() {
    let mut recording = two_rows("p_ch", Unit::BarGauge, [1.23456, -0.0001]);
    let (base, _) = recording.time_bases().next().unwrap();
    recording
        .add_signal("i_fill", Unit::Milliampere, base, vec![0.1, 1e-300])
        .unwrap();
    let decimals = Decimals::shortest()
        .with(Unit::BarGauge, 3)
        .with(Unit::Second, 2);
    let text = String::from_utf8(written(&recording, &decimals)).unwrap();
    assert!(
        text.ends_with("\n0.00,1.235,0.1\n0.01,-0.000,1e-300\n"),
        "{text}"
    );
}

#[test]
fn a_name_that_a_spreadsheet_would_run_is_disarmed_and_comes_back() {
    for name in ["=cmd|' /C calc'!A0", "+1", "-1", "@sum", "'=x", "#comment"] {
        let bytes = written(
            &two_rows(name, Unit::Volt, [1.0, 2.0]),
            &Decimals::shortest(),
        );
        let text = String::from_utf8(bytes.clone()).unwrap();
        let header = text
            .lines()
            .find(|line| line.starts_with("time_s"))
            .unwrap();
        let cell = header
            .strip_prefix("time_s,")
            .unwrap()
            .trim_start_matches('"');
        assert!(cell.starts_with('\''), "{header}");
        assert!(read_back(&bytes).signal(name).is_some(), "{header}");
    }
}

fn writer(decimals: &Decimals) -> Writer<Vec<u8>> {
    let columns = [Column {
        name: "i_fill".to_owned(),
        unit: Unit::Milliampere,
    }];
    Writer::new(
        Vec::new(),
        &Provenance::from_source("test"),
        &columns,
        decimals,
    )
    .unwrap()
}

#[test]
fn rows_that_no_reader_would_take_are_not_written() {
    let mut rows = writer(&Decimals::shortest());
    rows.write_row(0.0, &[1.0]).unwrap();
    let refused = |result: Result<(), WriteError>| result.unwrap_err();
    assert!(matches!(
        refused(rows.write_row(0.0, &[1.0])),
        WriteError::TimeOrder { row: 1, .. }
    ));
    assert!(matches!(
        refused(rows.write_row(f64::NAN, &[1.0])),
        WriteError::TimeOrder { .. }
    ));
    assert!(matches!(
        refused(rows.write_row(f64::INFINITY, &[1.0])),
        WriteError::TimeOrder { .. }
    ));
    assert!(matches!(
        refused(rows.write_row(0.1, &[f64::INFINITY])),
        WriteError::Infinite { row: 1, .. }
    ));
    assert!(matches!(
        refused(rows.write_row(0.1, &[])),
        WriteError::ValueCount {
            expected: 1,
            found: 0,
            ..
        }
    ));
    rows.write_row(0.1, &[f64::NAN]).unwrap();
    let text = String::from_utf8(rows.finish().unwrap()).unwrap();
    assert!(text.ends_with("i_fill_mA\n0,1\n0.1,\n"), "{text}");

    let mut rounded = writer(&Decimals::shortest().with(Unit::Second, 1));
    rounded.write_row(0.01, &[1.0]).unwrap();
    assert!(matches!(
        refused(rounded.write_row(0.02, &[1.0])),
        WriteError::TimeOrder { row: 1, .. }
    ));
    assert!(matches!(
        writer(&Decimals::shortest()).finish(),
        Err(WriteError::NoRows)
    ));
}

#[test]
fn a_header_that_no_reader_would_take_is_not_written() {
    let refused = |columns: &[(&str, Unit)]| {
        let columns: Vec<_> = columns
            .iter()
            .map(|&(name, unit)| Column {
                name: name.to_owned(),
                unit,
            })
            .collect();
        let sink = Vec::new();
        Writer::new(
            sink,
            &Provenance::default(),
            &columns,
            &Decimals::shortest(),
        )
        .err()
        .unwrap()
    };
    assert!(matches!(refused(&[]), WriteError::NoColumns));
    assert!(matches!(
        refused(&[("a\nb", Unit::Volt)]),
        WriteError::Name { .. }
    ));
    assert!(matches!(
        refused(&[("time", Unit::Second)]),
        WriteError::NameTaken { .. }
    ));
    assert!(matches!(
        refused(&[("a", Unit::Volt), ("a", Unit::Ampere)]),
        WriteError::NameTaken { .. }
    ));
}
