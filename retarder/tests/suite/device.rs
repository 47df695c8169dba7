//! Commands that talk to a device; here the device in process, which needs neither emulator nor board.

use serde_json::Value;

use crate::runner::{Bench, assert_contains};

#[test]
fn the_loop_on_a_device_names_it_and_compares_its_bits() {
    let bench = Bench::new();
    let out = bench.run(&["control", "--dut", "in-process"]).ended_with(0);
    assert_contains(
        &out,
        &[
            "Device",
            "in process",
            "same bits.",
            "at all 1641 samples",
            "Required by the thesis",
            "The loop meets every binding requirement.",
        ],
    );
    let json = bench
        .run(&["control", "--dut", "in-process", "--json"])
        .ended_with(0);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["first_different_sample"], Value::Null);
    assert_eq!(json["verdict"]["holds"], true);
    assert!(json["device"].as_str().unwrap().contains("in process"));
}

/// The live plot must not reach a file or a pipe.
#[test]
fn without_a_terminal_only_lines_are_printed() {
    let ran = Bench::new().run(&["control", "--dut", "in-process"]);
    assert_eq!(ran.err, "");
    assert!(!ran.out.contains('\u{1b}'), "{}", ran.out);
}

#[test]
fn a_fresh_device_has_an_empty_black_box_in_every_form() {
    let bench = Bench::new();
    let out = bench
        .run(&["blackbox", "--dut", "in-process"])
        .ended_with(0);
    assert_contains(&out, &["Black box", "no fault came", "0 samples"]);
    let csv = bench
        .run(&["blackbox", "--dut", "in-process", "--out", "-", "--clear"])
        .ended_with(0);
    assert!(csv.starts_with("record,p_ref_bar_gauge,"), "{csv}");
    let both = ["blackbox", "--dut", "in-process", "--out", "-", "--json"];
    assert_contains(&bench.run(&both).err, &["two results"]);
}

#[test]
fn settings_are_read_changed_together_and_refused_with_name_and_bound() {
    let bench = Bench::new();
    let all = bench
        .run(&["calibrate", "read", "--dut", "in-process"])
        .ended_with(0);
    for setting in &ecu::calibration::SETTINGS {
        assert_contains(&all, &[setting.name]);
    }
    let write = |assignments: &[&str]| {
        let command = ["calibrate", "write", "--dut", "in-process"];
        bench.run(&[&command, assignments].concat())
    };
    let changed = write(&["gain_pct_per_bar=30.5", "boost=off", "--save"]).ended_with(0);
    assert_contains(&changed, &["30.5", "off", "kept for the next start"]);
    assert_contains(&write(&["--defaults"]).ended_with(0), &["In effect until"]);
    for (assignment, said) in [
        (
            "gain_pct_per_bar=-3",
            "gain_pct_per_bar = -3 %/bar is out of range",
        ),
        ("supply_pressure_min_bar=14", "supply_pressure_max_bar"),
        ("boost=maybe", "one of off, on"),
        ("gian=3", "did you mean gain_pct_per_bar?"),
        ("gain_pct_per_bar", "SETTING=VALUE"),
    ] {
        let ran = write(&[assignment]);
        assert_contains(&ran.err, &[said]);
        ran.ended_with(2);
    }
}

#[test]
fn signals_are_listed_and_measured_only_where_a_timer_runs() {
    let bench = Bench::new();
    let out = bench.run(&["calibrate", "signals"]).ended_with(0);
    for (_, signal) in hil_harness::signals::all() {
        assert_contains(&out, &[signal.name]);
    }
    let measure = |signals: &[&str]| {
        let command = ["calibrate", "measure", "--dut", "in-process"];
        bench.run(&[&command, signals].concat()).err
    };
    assert_contains(&measure(&["u"]), &["has no sample timer", "--dut qemu"]);
    assert_contains(
        &measure(&["p_reff"]),
        &["no signal `p_reff`", "did you mean p_ref"],
    );
    assert_contains(&measure(&["u"; 17]), &["17 signals at once", "16 at most"]);
}

#[test]
fn a_device_that_is_not_there_is_named_with_what_to_do() {
    let bench = Bench::new();
    for (arguments, said) in [
        (
            vec!["control", "--dut", "quemu"],
            "expected in-process, qemu",
        ),
        (
            vec!["control", "--dut", "serial:/dev/no-such-port"],
            "check its name",
        ),
        (vec!["control", "--image", "image.elf"], "--dut"),
        (vec!["control", "--dut", "qemu", "--rigs", "2"], "--rigs"),
    ] {
        let ran = bench.run(&arguments);
        assert_contains(&ran.err, &[said]);
        ran.ended_with(2);
    }
    #[cfg(unix)]
    for (image, said) in [
        ("no-such.elf", "build it with `cargo xtask image`"),
        ("text.elf", "its log cannot be read"),
    ] {
        bench.file("text.elf", "no image");
        let ran = bench.run(&["control", "--dut", "qemu", "--image", image]);
        assert_contains(&ran.err, &[image, said]);
        ran.ended_with(2);
    }
}
