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
