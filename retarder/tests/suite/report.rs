#[cfg(target_os = "linux")]
use std::process::Stdio;

#[cfg(target_os = "linux")]
use crate::diagnose::interrupt;
#[cfg(target_os = "linux")]
use crate::runner::Ran;
use crate::runner::{Bench, assert_contains, beginning_of, data};

/// Log of the rig with a leak, and the time used from it (s).
const LEAKING: (&str, f64) = ("synthetic/practice-01-id.csv", 10.0);

/// Every part is in the file, including the loop on the refined plant, and the file needs no other file.
#[test]
fn a_report_has_comparison_diagnosis_and_the_loop_on_both_plants() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, LEAKING.1));
    let arguments = [
        "report",
        "--log",
        "bench.csv",
        "--scenario",
        "fill-requirement",
    ];
    let out = bench.run(&arguments).ended_with(1);
    assert_contains(
        &out,
        &[
            "compared with bench.csv",
            "Outside tolerance",
            "Missing: chamber leak",
            "nominal plant with chamber_leak: ",
            "Written: report.html",
        ],
    );
    let report = bench.read("report.html");
    assert_contains(
        &report,
        &[
            "id=\"logs\"",
            "id=\"plant\"",
            "id=\"model\"",
            "id=\"diagnosis\"",
            "Add the effect to the plant file",
            "id=\"control\"",
            "nominal plant with chamber_leak",
            "recommended controller",
            "retarder report --log bench.csv",
            "</html>",
        ],
    );
    for loading in ["<script", "src=\"http", "href=\"http", "url(http"] {
        assert!(!report.contains(loading), "{loading}");
    }
}

#[test]
fn a_loop_that_cannot_be_closed_is_left_out_with_the_reason() {
    let bench = Bench::new();
    let plant = data("plants/leakdown-chamber.toml");
    let log = data("real/leakdown-aluminium.csv");
    let arguments = [
        "report",
        "--plant",
        &plant,
        "--log",
        &log,
        "--without",
        "diagnosis",
    ];
    let out = bench.run(&arguments).ended_with(1);
    assert_contains(&out, &["The closed loop was left out", "needs both valves"]);
    assert_contains(
        &bench.read("report.html"),
        &["the closed loop was left out"],
    );
}

#[test]
fn parts_that_a_person_does_not_want_are_left_out() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, 4.0));
    let arguments = [
        "report",
        "--log",
        "bench.csv",
        "--without",
        "diagnosis",
        "--without",
        "control",
        "--out",
        "short.html",
    ];
    bench.run(&arguments).ended_with(1);
    let report = bench.read("short.html");
    assert!(report.contains("id=\"model\""));
    for part in ["id=\"diagnosis\"", "id=\"control\""] {
        assert!(!report.contains(part), "{part}");
    }
}

#[test]
fn a_check_log_is_compared_and_rigs_have_their_settling_times() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, 4.0));
    bench.file(
        "check.csv",
        &beginning_of("synthetic/practice-01-check.csv", 4.0),
    );
    let arguments = [
        "report",
        "--log",
        "bench.csv",
        "--check",
        "check.csv",
        "--without",
        "diagnosis",
        "--scenario",
        "fill-requirement",
        "--rigs",
        "3",
    ];
    bench.run(&arguments).ended_with(1);
    let report = bench.read("report.html");
    assert_contains(
        &report,
        &[
            "id=\"model-2\"",
            "check.csv",
            "Settling times on the scattered rigs",
            "of 3 meet every binding requirement",
        ],
    );
}

/// Defect seen: a report checked for Ctrl-C in its diagnosis only, and the later parts did not end.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_a_report_on_many_rigs_and_leaves_no_file() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, 2.0));
    let arguments = [
        "report",
        "--log",
        "bench.csv",
        "--scenario",
        "fill-requirement",
        "--without",
        "diagnosis",
        "--rigs",
        "100000",
    ];
    let child = bench
        .command(&arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    interrupt(&child);
    let ran = Ran::of(child.wait_with_output().unwrap());
    assert_contains(&ran.err, &["error: interrupted; nothing was written"]);
    assert_eq!(
        (ran.ended_with(2), bench.files()),
        (String::new(), vec!["bench.csv".to_owned()])
    );
}
