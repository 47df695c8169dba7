//! Bundled logs: they load without a mapping or with the bundled one, with the values shown in the files.

use std::path::{Path, PathBuf};

use recording::csv::{Mapping, Options, read_file};
use recording::{Quantity, Recording, Unit};

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../data")
        .join(path)
}

fn load(path: &str) -> Recording {
    read_file(data(path), &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Goal: every bundled file is read as expected. Method: number of signals and rows of each kind of log.
#[test]
fn every_practice_log_loads_with_its_signals_and_rows() {
    let mut seen = 0;
    for entry in std::fs::read_dir(data("synthetic")).expect("the bundled logs are there") {
        let path = entry.expect("the folder can be listed").path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !name.ends_with(".csv") {
            continue;
        }
        let recording =
            read_file(&path, &Options::default()).unwrap_or_else(|error| panic!("{error}"));
        let (signals, samples) = match name.rsplit_once('-').unwrap() {
            (_, "id.csv") => (6, 6000),
            (_, "check.csv") => (6, 4000),
            _ => (2, 2400),
        };
        assert_eq!(recording.signals().len(), signals, "{name}");
        for signal in recording.signals() {
            assert_eq!(
                (signal.len(), signal.missing_count()),
                (samples, 0),
                "{name} {}",
                signal.name()
            );
        }
        seen += 1;
    }
    assert_eq!(seen, 22);
}

#[test]
fn a_practice_log_has_the_quantities_and_values_of_its_columns() {
    let recording = load("synthetic/practice-00-id.csv");
    for (name, quantity, unit, second) in [
        ("duty_fill", Quantity::DutyCycle, Unit::Percent, 0.0),
        ("duty_vent", Quantity::DutyCycle, Unit::Percent, 0.0),
        ("p_ch", Quantity::Pressure, Unit::BarGauge, 0.0051),
        ("i_fill", Quantity::Current, Unit::Milliampere, -1.0),
        ("i_vent", Quantity::Current, Unit::Milliampere, -0.5),
        ("u_bat", Quantity::Voltage, Unit::Volt, 24.0),
    ] {
        let signal = recording.require(name, quantity).unwrap();
        assert_eq!(
            (signal.unit(), signal.get(1)),
            (unit, Some(second)),
            "{name}"
        );
    }
    let time_base = recording.time_base_of("p_ch").unwrap();
    assert_eq!(
        (
            time_base.start_s(),
            time_base.times_s()[1],
            time_base.end_s()
        ),
        (0.0, 0.01, 59.99)
    );
    let sampling = time_base.sampling();
    assert!(!sampling.uneven && sampling.gaps.is_empty());
    let input = recording
        .provenance()
        .input
        .expect("a file has a size and a hash");
    assert_eq!(
        input.size_bytes,
        std::fs::metadata(data("synthetic/practice-00-id.csv"))
            .unwrap()
            .len()
    );
}

#[test]
fn measurements_made_by_others_load_with_their_units() {
    for (path, name, unit, samples) in [
        (
            "real/blowdown-air-790kPa-pressure.csv",
            "p_ch",
            Unit::BarAbsolute,
            15,
        ),
        (
            "real/blowdown-air-790kPa-temperature.csv",
            "gas_temperature",
            Unit::Kelvin,
            14,
        ),
        (
            "real/inrush-burkert6724-blocked.csv",
            "i",
            Unit::Milliampere,
            500,
        ),
        (
            "real/inrush-burkert6724-switching.csv",
            "i",
            Unit::Milliampere,
            500,
        ),
        ("real/leakdown-aluminium.csv", "p_ch", Unit::BarGauge, 1508),
        (
            "real/leakdown-ultimaker-015.csv",
            "p_ch",
            Unit::BarGauge,
            1426,
        ),
        (
            "real/leakdown-ultimaker-020.csv",
            "p_ch",
            Unit::BarGauge,
            1443,
        ),
    ] {
        let recording = load(path);
        let signal = recording.signal(name).unwrap();
        assert_eq!((signal.unit(), signal.len()), (unit, samples), "{path}");
    }
    let inrush = load("real/inrush-burkert6724-blocked.csv");
    let times_s = inrush.time_base_of("i").unwrap().times_s();
    assert_eq!((times_s[1], times_s[499]), (5e-5, 0.02495));
    assert!(
        load("real/leakdown-aluminium.csv")
            .time_base_of("p_ch")
            .unwrap()
            .sampling()
            .uneven
    );
}

/// Semicolons, no header, microseconds with dots between the thousands, sensor volts, no line feed at the end.
#[test]
fn the_wild_file_gives_the_values_of_its_cleaned_copy() {
    let mapping = Mapping::parse(
        "ultimaker.toml",
        r#"
        schema = 1
        [time]
        column = 1
        unit = "us"
        thousands_separator = "."
        [signal.u_sensor]
        column = 2
        unit = "V"
        [signal.p_from_sensor]
        column = 2
        unit = "bar_gauge"
        scale = 2.0
        [signal.p_ch]
        column = 3
        unit = "bar_gauge"
        "#,
    )
    .unwrap();
    let options = Options {
        mapping,
        ..Options::default()
    };
    let wild = read_file(data("real/raw/Ultimaker_015.csv"), &options)
        .unwrap_or_else(|error| panic!("{error}"));
    let clean = load("real/leakdown-ultimaker-015.csv");
    assert_eq!(
        wild.time_base_of("p_ch").unwrap(),
        clean.time_base_of("p_ch").unwrap()
    );
    let pressure = wild.signal("p_ch").unwrap();
    assert_eq!(
        pressure.values_or_nan(),
        clean.signal("p_ch").unwrap().values_or_nan()
    );
    assert_eq!(wild.signal("u_sensor").unwrap().get(0), Some(3.826));
    let from_sensor = wild.signal("p_from_sensor").unwrap();
    for (from_sensor, pressure) in from_sensor.iter().zip(pressure.iter()) {
        // The logger rounded both to three decimals.
        assert!((from_sensor.unwrap() - pressure.unwrap()).abs() < 0.0016);
    }
}

#[test]
fn the_wild_file_is_refused_without_a_mapping_and_says_so() {
    let error = read_file(data("real/raw/Ultimaker_015.csv"), &Options::default()).unwrap_err();
    assert_eq!(error.code(), "E-CSV-HEADER");
    assert!(error.to_string().contains("mapping"), "{error}");
}

fn load_mapped(path: &str, mapping: &str) -> Recording {
    let options = Options {
        mapping: Mapping::read_file(data(mapping)).unwrap_or_else(|error| panic!("{error}")),
        ..Options::default()
    };
    read_file(data(path), &options).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_mapping_says_what_the_inrush_logs_leave_unsaid() {
    for log in ["switching", "blocked"] {
        let path = format!("real/inrush-burkert6724-{log}.csv");
        let recording = load_mapped(&path, "real/inrush.toml");
        let duty = recording.require("duty_fill", Quantity::DutyCycle).unwrap();
        assert_eq!(duty.unit(), Unit::Percent);
        assert_eq!(duty.values_or_nan(), [100.0; 500]);
        let current = recording.require("i_fill", Quantity::Current).unwrap();
        assert_eq!(current.time_base(), duty.time_base());
    }
}

/// The first kept row follows the first one that is lower than all before it by more than the noise.
#[test]
fn the_leak_down_logs_are_cut_where_the_supply_was_shut_off() {
    for (name, plateau, first) in [
        ("leakdown-ultimaker-015", 7.652, 7.448),
        ("leakdown-ultimaker-020", 7.671, 5.104),
    ] {
        let whole = load(&format!("real/{name}.csv"));
        let cut = load_mapped(&format!("real/{name}.csv"), &format!("real/{name}.toml"));
        let times_s = cut.time_base_of("p_ch").unwrap().times_s();
        assert_eq!(times_s[0], first, "{name}");
        let dropped = whole.time_base_of("p_ch").unwrap().len() - times_s.len();
        let values = whole.signal("p_ch").unwrap().values_or_nan();
        let (before, lower) = (&values[..dropped - 1], &values[dropped - 1..]);
        assert!(
            before.iter().all(|bar| (bar - plateau).abs() < 0.013),
            "{name}"
        );
        assert!(lower.iter().all(|bar| *bar < plateau - 0.03), "{name}");
        assert_eq!(cut.signal("p_ch").unwrap().values_or_nan(), &lower[1..]);
    }
}

#[test]
fn a_mapping_that_keeps_no_row_or_contradicts_the_file_is_refused() {
    for (lines, code) in [
        ("[rows]\nfrom_s = 1e6", "E-CSV-NO-ROW-KEPT"),
        (
            "[constant.p_ch]\nvalue = 1\nunit = \"bar_gauge\"",
            "E-CSV-CONSTANT-LOGGED",
        ),
    ] {
        let mapping = Mapping::parse("test.toml", &format!("schema = 1\n{lines}\n")).unwrap();
        let options = Options {
            mapping,
            ..Options::default()
        };
        let error = read_file(data("real/leakdown-aluminium.csv"), &options).unwrap_err();
        assert_eq!(error.code(), code, "{error}");
    }
}
