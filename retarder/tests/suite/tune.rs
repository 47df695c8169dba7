//! `tune`: a controller file for a plant.

use crate::runner::{Bench, assert_contains};

/// Plant file with a normally open vent valve.
fn normally_open(bench: &Bench) -> String {
    let preload = "armature.preload_vent_n=1";
    let plant = bench
        .run(&["parameters", "--toml", "--set", preload])
        .ended_with(0);
    let closed = "vent = \"normally_closed\"";
    assert_contains(&plant, &[closed]);
    plant.replace(closed, "vent = \"normally_open\"")
}

/// Each changed value names the plant, the rest is the text of the controller, and the loop accepts the file.
#[test]
fn a_tuned_controller_file_has_the_limits_of_the_plant_and_meets_its_requirements() {
    let bench = Bench::new();
    bench.file("plant.toml", &normally_open(&bench));
    let tuned = bench.run(&["tune", "--plant", "plant.toml"]).ended_with(0);
    assert_contains(
        &tuned,
        &[
            "gain_pct_per_bar = 35   # tuned: 26 does not overshoot",
            "# `retarder tune`, plant.toml",
            "vent_without_pressure_pct = 29.",
        ],
    );
    bench.file("controller.toml", &tuned);
    let again = [
        "tune",
        "--plant",
        "plant.toml",
        "--controller",
        "controller.toml",
    ];
    assert_eq!(bench.run(&again).ended_with(0), tuned);
    bench
        .run(&[
            "control",
            "--plant",
            "plant.toml",
            "--controller",
            "controller.toml",
            "--scenario",
            "operating-range",
        ])
        .ended_with(0);
}

#[test]
fn a_plant_whose_valve_no_current_opens_is_refused_by_the_name_of_the_valve() {
    let bench = Bench::new();
    let ran = bench.run(&["tune", "--set", "ecu.supply_voltage_v=6"]);
    assert_eq!((ran.status, ran.out.as_str()), (2, ""));
    assert_contains(
        &ran.err,
        &["no duty cycle opens the fill valve", "supply voltage"],
    );
}

/// Goal: the file has the gains of the experiment and says where they come from. Method: the file runs in the loop.
#[test]
fn gains_of_an_experiment_say_where_they_come_from() {
    let bench = Bench::new();
    let tuned = bench.run(&["tune", "--gains", "relay"]).ended_with(0);
    assert_contains(&tuned, &["# `retarder tune --gains relay`, nominal plant"]);
    assert!(!tuned.contains("gain_pct_per_bar = 35 "), "{tuned}");
    bench.file("controller.toml", &tuned);
    let fill = ["--scenario", "fill-requirement"];
    let control = ["control", "--controller", "controller.toml"];
    bench.run(&[&control[..], &fill[..]].concat()).ended_with(0);
}

/// Goal: a search writes its controller file, its table and its picture, and is repeatable.
#[test]
fn a_search_writes_its_controller_and_shows_its_trade_off() {
    let bench = Bench::new();
    let search = [
        "tune",
        "--search",
        "6",
        "--rigs",
        "2",
        "--out",
        "controller.toml",
        "--html",
        "gains.html",
    ];
    let shown = bench.run(&search).ended_with(0);
    assert_contains(
        &shown,
        &[
            "6 candidates on 2 rigs each, seed 1",
            "given",
            "relay",
            "ziegler-nichols",
            " *",
            "On 6 rigs that decided nothing:",
            "Written: controller.toml",
            "Written: gains.html",
        ],
    );
    let written = bench.read("controller.toml");
    let page = bench.read("gains.html");
    assert_contains(
        &page,
        &[
            "Settling time, overshoot and lifts of the candidates",
            "<svg",
        ],
    );
    // Without --out, the standard output has the file and the standard error the table.
    let printed = bench.run(&search[..5]);
    assert_eq!((printed.status, printed.out), (0, written));
    assert_contains(&printed.err, &["On 6 rigs that decided nothing:"]);
}

#[test]
fn pulses_have_no_gains_to_search() {
    let bench = Bench::new();
    let ran = bench.run(&["tune", "--controller", "pulses", "--search"]);
    assert_eq!((ran.status, ran.out.as_str()), (2, ""));
    assert_contains(
        &ran.err,
        &[
            "pulses controller",
            "have no gains",
            "without the table [pulses]",
        ],
    );
}
