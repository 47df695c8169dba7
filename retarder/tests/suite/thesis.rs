use model_lab::thesis::ThesisTable;

use crate::runner::{Bench, assert_contains};

#[test]
fn the_nominal_plant_reaches_the_figures_that_it_is_held_to() {
    let bench = Bench::new();
    let out = bench
        .run(&["thesis", "--json", "t.json", "--html", "t.html"])
        .ended_with(0);
    assert_contains(
        &out,
        &[
            "Duty limits",
            "prototype 2, 75 cm³, 1.9 mm",
            "coil_heating",
            "The plain model reaches",
        ],
    );
    let table: ThesisTable = serde_json::from_str(&bench.read("t.json")).unwrap();
    assert!(table.holds && table.schema == "retarder.thesis/1");
}

#[test]
fn a_wrong_plant_does_not() {
    let bench = Bench::new();
    let out = bench
        .run(&["thesis", "--set", "armature.preload_fill_n=4.5"])
        .ended_with(1);
    assert_contains(&out, &["FAIL", "preload_fill_n = 4.5"]);
}

#[test]
fn the_supply_line_explains_the_filling_times() {
    let bench = Bench::new();
    let out = bench.run(&["thesis", "--explain"]).ended_with(0);
    assert_contains(
        &out,
        &[
            "The times come in",
            "regulator_droop_bar_s_per_g",
            "line_volume_m3 = ",
            "0.740",
            "not fitted",
        ],
    );
}
