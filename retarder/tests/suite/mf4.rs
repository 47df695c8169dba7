//! Logs and recordings as MF4, Parquet and MATLAB in every place that accepts CSV.

use std::fs::File;

use model_lab::Comparison;
use recording::{Provenance, Recording, TimeBase, Unit, csv, mf4};

use crate::runner::{Bench, assert_contains, data, short_log};

fn write_mf4(bench: &Bench, name: &str, recording: &Recording) {
    mf4::write(File::create(bench.path(name)).unwrap(), recording).unwrap();
}

/// Creates a bench with the short log as CSV and as MF4.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("log.csv", &short_log());
    let options = csv::Options::default();
    let log = csv::read("log.csv", short_log().as_bytes(), &options).unwrap();
    write_mf4(&bench, "log.mf4", &log);
    bench
}

#[test]
fn a_log_gives_the_same_rows_in_either_format_and_from_the_standard_input() {
    let bench = bench();
    let rows = |text: &str| text.split_once("time_s").unwrap().1.to_owned();
    let csv = bench.run(&["simulate", "--log", "log.csv"]).ended_with(0);
    let mf4 = bench.run(&["simulate", "--log", "log.mf4"]).ended_with(0);
    assert_eq!(rows(&mf4), rows(&csv));
    let output = bench
        .command(&["simulate", "--log", "-"])
        .stdin(File::open(bench.path("log.mf4")).unwrap())
        .output()
        .unwrap();
    assert_eq!(rows(&String::from_utf8(output.stdout).unwrap()), rows(&csv));
}

/// A recording that `simulate` wrote in one format is a log for `simulate` in another.
#[test]
fn parquet_and_matlab_are_written_and_read_like_csv() {
    let bench = bench();
    let rows = |text: &str| text.split_once("time_s").unwrap().1.to_owned();
    let csv = bench.run(&["simulate", "--log", "log.csv"]).ended_with(0);
    for name in ["model.parquet", "model.mat"] {
        let ran = bench.run(&["simulate", "--log", "log.csv", "--out", name]);
        assert_contains(&ran.err, &[&format!("Written: {name}")]);
        ran.ended_with(0);
        let again = bench.run(&["simulate", name]).ended_with(0);
        assert_eq!(
            rows(&again).lines().count(),
            rows(&csv).lines().count(),
            "{name}"
        );
        let out = bench.run(&["inspect", name]).ended_with(0);
        assert_contains(&out, &["The file needs no mapping.", "p_ch_bar_gauge"]);
        let piped = bench.run_reading(&["compare", "-", "--json"], name).out;
        let json = bench.run(&["compare", name, "--json"]).out;
        let signals = |text: &str| text.split_once("\"signals\"").unwrap().1.to_owned();
        assert_eq!(signals(&piped), signals(&json), "{name}");
        assert_contains(&json, &["\"rms\": 0.0"]);
        let wrong = bench.run(&["compare", "--plant", name]);
        assert_contains(
            &wrong.err,
            &["expects a plant file (TOML), and this is a log"],
        );
    }
    let run = |out: &str| bench.run(&["control", "--scenario", "figure-6.5", "--out", out]);
    run("run.parquet");
    run("run.csv");
    let options = recording::LogOptions::default();
    let [parquet, csv] = ["run.parquet", "run.csv"]
        .map(|name| recording::read_log_file(bench.path(name), &options).unwrap());
    assert_eq!(parquet.signals(), csv.signals());
    let refused = bench.run(&["blackbox", "--dut", "in-process", "--out", "box.mat"]);
    assert_contains(&refused.err, &["choose a name that ends in .csv"]);
}

/// MF4 values are not rounded to decimals as in CSV: the comparison uses the model's exact values.
#[test]
fn a_simulated_mf4_equals_its_own_plant_without_any_error() {
    let bench = Bench::new();
    let log = data("synthetic/practice-00-check.csv");
    let ran = bench.run(&["simulate", "--log", &log, "--out", "model.mf4"]);
    assert_contains(&ran.err, &["Written: model.mf4"]);
    ran.ended_with(0);
    let json = bench
        .run(&["compare", "--log", "model.mf4", "--json"])
        .ended_with(0);
    assert_contains(&json, &["\"rms\": 0.0"]);
    let read = mf4::read_file(bench.path("model.mf4"), &mf4::Options::default()).unwrap();
    assert!(
        read.provenance()
            .producer
            .as_deref()
            .unwrap()
            .starts_with("retarder ")
    );
    assert_eq!(bench.files(), ["model.mf4"]);
}

#[test]
fn the_closed_loop_is_written_as_mf4() {
    let bench = Bench::new();
    let run = |out: &str| {
        let scenario = ["control", "--scenario", "figure-6.5", "--out", out];
        bench.run(&scenario);
    };
    run("run.mf4");
    run("run.csv");
    let mf4 = mf4::read_file(bench.path("run.mf4"), &mf4::Options::default()).unwrap();
    let csv = csv::read_file(bench.path("run.csv"), &csv::Options::default()).unwrap();
    assert_eq!(mf4.signals(), csv.signals());
}

/// Pressure at 1 kHz, commands at 100 Hz: each at its own instants, or at those that a mapping chooses.
#[test]
fn two_rates_are_compared_as_they_are_or_at_the_instants_of_one() {
    let bench = Bench::new();
    let log = data("synthetic/practice-00-id.csv");
    let log = csv::read_file(log, &csv::Options::default()).unwrap();
    let (_, slow) = log.time_bases().next().unwrap();
    let mut rates = Recording::new(Provenance::from_source("bench"));
    let slow_id = rates.add_time_base(slow.clone());
    for name in ["duty_fill", "duty_vent", "u_bat"] {
        let signal = log.signal(name).unwrap();
        let values = signal.values_or_nan().to_vec();
        rates
            .add_signal(name, signal.unit(), slow_id, values)
            .unwrap();
    }
    let mut one = rates.clone();
    let pressure = log.signal("p_ch").unwrap().values_or_nan();
    one.add_signal("p_ch", Unit::BarGauge, slow_id, pressure.to_vec())
        .unwrap();
    write_mf4(&bench, "one-rate.mf4", &one);
    let fast = TimeBase::uniform(0.0, 0.001, 10 * slow.len()).unwrap();
    let fast_id = rates.add_time_base(fast);
    let held = pressure.iter().flat_map(|value| [*value; 10]).collect();
    rates
        .add_signal("p_ch", Unit::BarGauge, fast_id, held)
        .unwrap();
    write_mf4(&bench, "two-rate.mf4", &rates);
    let compare = ["compare", "--log", "two-rate.mf4", "--json", "two.json"];
    bench.run(&compare).ended_with(1);
    let compared: Comparison = serde_json::from_str(&bench.read("two.json")).unwrap();
    let [p_ch] = &compared.signals[..] else {
        panic!("{:?}", compared.signals);
    };
    assert_eq!((p_ch.compared, p_ch.missing), (10 * slow.len(), 0));
    bench.file(
        "at.toml",
        "schema = 1\nrows = { instants_of = \"duty_fill\" }\n",
    );
    let ran = bench.run(&["compare", "--log", "two-rate.mf4", "--mapping", "at.toml"]);
    assert_contains(
        &ran.err,
        &["note: two-rate.mf4: all signals are as they were known"],
    );
    let at_commands = ran.ended_with(1);
    // Commands held for ten samples are sampled down again: the figures equal those of one rate.
    let itself = bench
        .run(&["compare", "--log", "one-rate.mf4"])
        .ended_with(1);
    assert_eq!(at_commands.replace("two-rate", "one-rate"), itself);
}

#[test]
fn a_signal_that_needs_a_mapping_is_an_error_where_it_matters() {
    let bench = bench();
    let mut bytes = std::fs::read(bench.path("log.mf4")).unwrap();
    let unit = bytes.windows(2).rposition(|text| text == b"%\0").unwrap();
    bytes[unit] = b'?';
    std::fs::write(bench.path("odd.mf4"), bytes).unwrap();
    let ran = bench.run(&["simulate", "--log", "odd.mf4"]);
    assert_contains(
        &ran.err,
        &[
            "note: odd.mf4: channels that are no signals: 1, duty_vent",
            "\"duty_vent\" in odd.mf4 was left out: found \"?\", expected a unit",
            "signal.duty_vent = { column = \"duty_vent\"",
        ],
    );
    assert_eq!(ran.ended_with(2), "");
}

#[test]
fn a_damaged_file_and_a_wrong_name_are_reported() {
    let bench = bench();
    let bytes = std::fs::read(bench.path("log.mf4")).unwrap();
    std::fs::write(bench.path("cut.mf4"), &bytes[..bytes.len() - 100]).unwrap();
    let ran = bench.run(&["compare", "--log", "cut.mf4"]);
    assert_contains(
        &ran.err,
        &["E-MF4-LENGTH: cut.mf4, block ##DT at byte", "copy it again"],
    );
    ran.ended_with(2);
    let measure = [
        "calibrate",
        "measure",
        "--dut",
        "in-process",
        "--out",
        "m.mf4",
        "u",
    ];
    let ran = bench.run(&measure);
    assert_contains(
        &ran.err,
        &["m.mf4: only recordings of `simulate` and `control`"],
    );
    ran.ended_with(2);
}
