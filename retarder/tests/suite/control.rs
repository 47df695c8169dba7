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
        ("retarder.control/3", 2)
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

/// Returns the text with its lines and spaces joined: a sentence may be wrapped anywhere.
fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Defect seen: with an offset of 0.5 bar, the loop met every requirement.
#[test]
fn an_offset_of_the_sensor_fails_the_loop_and_is_shown_apart() {
    let bench = Bench::new();
    let offset = "effects.sensor_offset.offset_bar=0.5";
    let out = bench.run(&["control", "--set", offset]).ended_with(1);
    assert_contains(
        &unwrapped(&out),
        &[
            "The loop fails: reach 0.18 to 0.71 p_sup, stay, error after T_req.",
            "(measured minus true pressure) is 0.50 bar on average",
        ],
    );
    let json = bench
        .run(&["control", "--set", offset, "--json"])
        .ended_with(1);
    let verdict: Verdict = serde_json::from_str(&json).unwrap();
    assert!((verdict.sensor_error.unwrap().mean_bar - 0.5).abs() < 0.01);
    let sound = bench.run(&["control"]).ended_with(0);
    assert!(
        !unwrapped(&sound).contains("measured minus true"),
        "{sound}"
    );
}

/// Defect seen: at a low supply voltage the loop failed without a word about the fault that the ECU had confirmed.
#[test]
fn a_fault_that_the_ecu_confirmed_is_named() {
    let bench = Bench::new();
    for (condition, fault) in [
        (["--supply-voltage", "14"], "BatteryLow"),
        (["--supply-voltage", "40"], "BatteryHigh"),
    ] {
        let arguments = [&["control"], condition.as_slice()].concat();
        let out = bench.run(&arguments).ended_with(1);
        assert_contains(
            &unwrapped(&out),
            &[
                &format!("The ECU confirmed {fault}."),
                &format!("the ECU confirmed {fault} at"),
            ],
        );
        let json = bench
            .run(&[arguments.as_slice(), &["--json"]].concat())
            .ended_with(1);
        let verdict: Verdict = serde_json::from_str(&json).unwrap();
        let faults = verdict.confirmed_faults.unwrap();
        assert!(
            faults
                .iter()
                .any(|one| one.fault == fault && one.samples > 10),
            "{faults:?}"
        );
    }
    for condition in [["--supply-voltage", "18"], ["--coil-temperature", "120"]] {
        let arguments = [&["control", "--json"], condition.as_slice()].concat();
        let sound = bench.run(&arguments).ended_with(0);
        let verdict: Verdict = serde_json::from_str(&sound).unwrap();
        assert_eq!(verdict.confirmed_faults, Some(Vec::new()), "{condition:?}");
    }
}

#[test]
fn conditions_scatter_from_rig_to_rig_unless_they_are_given() {
    let bench = Bench::new();
    let control = ["control", "--rigs", "12", "--seed", "2026"];
    let vehicles = bench.run(&control).ended_with(1);
    assert_contains(
        &unwrapped(&vehicles),
        &[
            "`--supply-voltage 24 --coil-temperature 20` gives every rig",
            "of 12 rigs meet",
        ],
    );
    let bench_conditions = ["--supply-voltage", "24", "--coil-temperature", "20"];
    let bench_rigs = bench
        .run(&[control.as_slice(), &bench_conditions].concat())
        .ended_with(0);
    assert_contains(
        &unwrapped(&bench_rigs),
        &["12 of 12 rigs meet every binding requirement."],
    );
}

/// Defect seen: the report of a loop at 28 V and 60 °C named neither.
#[test]
fn a_report_names_the_operating_conditions() {
    let bench = Bench::new();
    let conditions = ["--supply-voltage", "26", "--coil-temperature", "30"];
    let out = bench.run(&[&["control", "--html", "c.html"], conditions.as_slice()].concat());
    assert_contains(&out.ended_with(0), &["26 V", "30 °C"]);
    assert_contains(
        &bench.read("c.html"),
        &["Supply voltage from time 0 on: 26 V. Coils at 30 °C."],
    );
}

#[test]
fn requirements_of_a_file_decide_and_are_named() {
    let bench = Bench::new();
    let thesis = bench.run(&["settings", "--requirements"]).ended_with(0);
    bench.file("mine.toml", &thesis);
    bench
        .run(&["control", "--requirements", "mine.toml"])
        .ended_with(0);
    bench.file(
        "strict.toml",
        "[overshoot]\nmax_bar = 0\nbinding = true\n\n[lifts]\nmean_per_s = 1.5\n",
    );
    let out = bench
        .run(&["control", "--requirements", "strict.toml"])
        .ended_with(1);
    assert_contains(
        &unwrapped(&out),
        &[
            "Requirements: strict.toml.",
            "The loop fails: overshoot, valve lifts per second.",
        ],
    );
    bench.file("wrong.toml", "[lifts]\nat_rest_per_s = -1\n");
    let refused = bench.run(&["control", "--requirements", "wrong.toml"]);
    assert_eq!(refused.status, 2);
    assert_contains(
        &unwrapped(&refused.err),
        &[
            "wrong.toml:2: `lifts.at_rest_per_s` = -1 is out of range; write a whole number from 0 to 10000",
        ],
    );
}

#[test]
fn a_small_chamber_is_warned_about() {
    let bench = Bench::new();
    let ran = bench.run(&["control", "--set", "chamber.volume_m3=25e-6"]);
    assert_contains(
        &unwrapped(&ran.err),
        &["note: chamber.volume_m3 = 25 cm3 is small for these orifices: below 31 cm3"],
    );
    assert_eq!(bench.run(&["control"]).err, "");
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
    assert_contains(&ran.out, &["3 rigs scattered", "is the first that fails"]);
    assert_eq!(ran.status, 1);
    assert_eq!(ran.out, bench.run(&arguments).out);
}
