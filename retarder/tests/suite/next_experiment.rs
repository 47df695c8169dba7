//! Experiments that determine parameters.

use crate::runner::{Bench, assert_contains, data};

/// Plans the experiment that a refinement proposes for the parameters that it left undetermined.
pub(crate) fn experiment_proposed_by(bench: &Bench, refined: &str) {
    let mut lines = refined.lines().map(str::trim_start);
    let line = lines.find(|line| line.starts_with("retarder next-experiment "));
    let command = line.unwrap().split("    #").next().unwrap();
    assert_contains(
        command,
        &[
            "--plant fitted.toml --log bench.csv --determine ",
            "--out next.csv",
        ],
    );
    let open: Vec<&str> = command
        .split(" --determine ")
        .skip(1)
        .map(|rest| rest.split(' ').next().unwrap())
        .collect();
    let mut arguments: Vec<&str> = command.split(' ').skip(1).collect();
    arguments.extend(["--duration", "6"]);
    let planned = bench.run(&arguments);
    assert!(planned.status < 2, "{}", planned.err);
    assert_contains(&planned.out, &open);
    assert_contains(
        &bench.read("next.csv"),
        &["time_s,duty_fill_pct,duty_vent_pct"],
    );
    for name in open {
        let is_row =
            |line: &&str| line.starts_with(&name[..name.len().min(20)]) && line.contains(" to ");
        let row = planned.out.lines().find(is_row).unwrap();
        assert!(
            row.ends_with("determined") || row.ends_with("open"),
            "{row}"
        );
    }
}

#[test]
fn parameters_that_no_experiment_determines_are_refused() {
    let bench = Bench::new();
    let log = data("synthetic/practice-01-check.csv");
    for (key, expected) in [
        (
            "chamber.volume",
            "has no parameter or table `chamber.volume`",
        ),
        (
            "armature.stroke_m",
            "`armature.stroke_m` = 0.0005 m counts as exact",
        ),
    ] {
        let ran = bench.run(&["next-experiment", "--log", &log, "--determine", key]);
        assert_eq!((ran.status, &*ran.out), (2, ""), "{key}");
        assert_contains(&ran.err, &["error: ", expected]);
    }
}
