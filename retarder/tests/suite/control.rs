use hil_harness::Verdict;

use crate::runner::{Bench, assert_contains};

#[test]
fn the_recommended_controller_holds_on_the_profile_of_the_figures() {
    let bench = Bench::new();
    let out = bench.run(&["control"]).ended_with(0);
    assert_contains(
        &out,
        &[
            "figure-6.5",
            "recommended controller",
            "reference",
            "vent (downwards)",
            "≤ 50 samples",
            "pass",
        ],
    );
}

#[test]
fn a_profile_of_ones_own_is_run_and_its_recording_is_read_again() {
    let bench = Bench::new();
    bench.file(
        "profile.csv",
        "time_s,p_ref_bar_gauge\n0,0\n0.5,3\n2,2\n4,2\n",
    );
    let out = bench
        .run(&[
            "control",
            "--reference",
            "profile.csv",
            "--out",
            "run.csv",
            "--html",
            "run.html",
            "--json",
            "v.json",
        ])
        .ended_with(0);
    assert_contains(
        &out,
        &[
            "profile:",
            "Written: run.csv",
            "Written: run.html",
            "Written: v.json",
        ],
    );
    let verdict: Verdict = serde_json::from_str(&bench.read("v.json")).unwrap();
    assert_eq!(
        (verdict.schema.as_str(), verdict.steps.len()),
        ("retarder.control/1", 2)
    );
    let header = bench.read("run.csv");
    assert_contains(&header, &["p_ref_bar_gauge,p_ch_bar_gauge"]);
    let alone = bench
        .run(&["control", "--reference", "profile.csv", "--out", "-"])
        .ended_with(0);
    assert_eq!(alone, bench.read("run.csv"));
    // The reference of a run can be used as a reference profile.
    bench
        .run(&["control", "--reference", "run.csv"])
        .ended_with(0);
}

#[test]
fn a_controller_that_cannot_settle_does_not_hold() {
    let bench = Bench::new();
    let settings = bench
        .run(&["settings", "--controller", "thesis", "--toml"])
        .ended_with(0);
    bench.file(
        "weak.toml",
        &settings.replace("gain_pct_per_bar = 40", "gain_pct_per_bar = 0.1"),
    );
    let out = bench
        .run(&["control", "--controller", "weak.toml", "--scenario", "hold"])
        .ended_with(1);
    assert_contains(&out, &["The loop fails: reach 0.18 to 0.71 p_sup, stay"]);
}

#[test]
fn rigs_are_repeated_by_their_seed_and_count_for_the_answer() {
    let bench = Bench::new();
    let arguments = [
        "control",
        "--controller",
        "thesis",
        "--scenario",
        "vent-requirement",
        "--rigs",
        "3",
        "--seed",
        "7",
    ];
    let ran = bench.run(&arguments);
    assert_contains(&ran.out, &["3 rigs scattered", "Rig 0 (seed"]);
    assert_eq!(ran.status, 1);
    assert_eq!(ran.out, bench.run(&arguments).out);
}
