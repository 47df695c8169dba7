//! Every kind of mistake once: status 2, nothing on the standard output, and a message with cause, value, allowed range
//! and the next step.

use crate::runner::{Bench, assert_contains, beginning_of, data, short_log};

fn bench() -> Bench {
    let bench = Bench::new();
    bench
        .file("log.csv", &short_log())
        .file(
            "back.csv",
            "time_s,duty_fill_pct\n0.00,0\n0.02,0\n0.01,0\n0.03,0\n",
        )
        .file("no-unit.csv", "time_s,duty_fill\n0.00,0\n0.01,0\n")
        .file("no-duty.csv", "time_s,p_ch_bar_gauge\n0.00,0\n0.01,0\n")
        .file("low.csv", "time_s,p_ref_bar_gauge\n0,0\n1,15.5\n")
        .file("broken.toml", "[ecu\n")
        .file("empty.toml", "")
        .file("large.toml", &"#\n".repeat(600_000));
    std::fs::write(bench.path("binary.toml"), b"\xff\xfe[\x00").unwrap();
    let plant = bench.run(&["parameters", "--toml"]).ended_with(0);
    bench
        .file(
            "range.toml",
            &plant.replace("resistance_20c_ohm = 82.2", "resistance_20c_ohm = -82.2"),
        )
        .file(
            "unit.toml",
            &plant.replace("stroke_m = 0.5e-3", "stroke_mm = 0.5"),
        )
        .file("key.toml", &plant.replace("[gas]", "[gas]\nhumidity = 3"));
    let controller = bench
        .run(&["settings", "--controller", "thesis", "--toml"])
        .ended_with(0);
    bench.file(
        "gain.toml",
        &controller.replace("gain_pct_per_bar = 40", "gain_pct_per_bar = -40"),
    );
    bench
}

#[track_caller]
fn check(bench: &Bench, arguments: &[&str], expected: &[&str]) {
    let before = bench.files();
    let ran = bench.run(arguments);
    assert_contains(&ran.err, expected);
    assert!(ran.err.starts_with("error: "), "{}", ran.err);
    assert!(!ran.err.contains("panicked"), "{}", ran.err);
    assert_eq!((ran.status, ran.out.as_str()), (2, ""), "{arguments:?}");
    assert_eq!(bench.files(), before);
}

#[test]
fn files_that_are_not_there_or_no_text() {
    let bench = bench();
    check(
        &bench,
        &["compare", "--log", "absent.csv"],
        &["absent.csv", "No such file"],
    );
    check(
        &bench,
        &["simulate", "--log", "absent.csv"],
        &["absent.csv", "check the name"],
    );
    check(
        &bench,
        &["thesis", "--plant", "absent.toml"],
        &["absent.toml", "check the name"],
    );
    check(
        &bench,
        &["thesis", "--plant", "binary.toml"],
        &["binary.toml", "save it as UTF-8"],
    );
    check(
        &bench,
        &["thesis", "--plant", "large.toml"],
        &["large.toml", "1048576 bytes"],
    );
    check(
        &bench,
        &[
            "simulate",
            "--log",
            "log.csv",
            "--out",
            "no/such/folder/out.csv",
        ],
        &[
            "no/such/folder/out.csv",
            "could not be written",
            "create its folder",
        ],
    );
}

/// The log has no pressure, an error that only the work itself would find.
#[test]
fn results_that_cannot_be_written_are_reported_before_the_work() {
    let bench = bench();
    let diagnose = ["diagnose", "--log", "log.csv"];
    let with = |option, path| [&diagnose[..], &[option, path]].concat();
    check(&bench, &with("--json", "-"), &["p_ch"]);
    for (option, path, reason) in [
        ("--json", "no/such/folder/found.json", "No such file"),
        ("--html", "no/such/folder/found.html", "No such file"),
        ("--json", ".", "not a regular file"),
    ] {
        check(
            &bench,
            &with(option, path),
            &[path, "could not be written", reason],
        );
    }
}

#[test]
fn plant_files_with_the_line_and_a_mark() {
    let bench = bench();
    check(
        &bench,
        &["thesis", "--plant", "broken.toml"],
        &["broken.toml:1", "not valid TOML", "1 | [ecu"],
    );
    check(
        &bench,
        &["thesis", "--plant", "empty.toml"],
        &["`sample_time_s` is missing in [ecu]"],
    );
    check(
        &bench,
        &["thesis", "--plant", "range.toml"],
        &[
            "range.toml:",
            "= -82.2 is out of range: allowed 0.5 to 5000 ohm",
            " | resistance_20c_ohm = -82.2",
            "| ^^^^",
        ],
    );
    check(
        &bench,
        &["thesis", "--plant", "unit.toml"],
        &["stroke_mm", "write `stroke_m = 5e-4`"],
    );
    check(
        &bench,
        &["thesis", "--plant", "key.toml"],
        &["unknown parameter `gas.humidity`", "retarder parameters"],
    );
}

#[test]
fn parameters_on_the_command_line() {
    let bench = bench();
    let set = |assignment| ["thesis", "--set", assignment];
    check(&bench, &set("coil.resistance"), &["NAME=VALUE"]);
    check(
        &bench,
        &set("coil.resistance=80"),
        &["unknown parameter `coil.resistance`; write `coil.resistance_20c_ohm`"],
    );
    check(
        &bench,
        &set("chamber.volume=80e-6"),
        &["unknown parameter `chamber.volume`; write `chamber.volume_m3`"],
    );
    check(
        &bench,
        &set("humidity=3"),
        &["unknown parameter `humidity`", "retarder parameters"],
    );
    check(
        &bench,
        &set("chamber.volume_m3=80"),
        &["= 80 is out of range: allowed"],
    );
    check(
        &bench,
        &set("chamber.volume_m3=8,0"),
        &["`8,0` is no number"],
    );
    check(
        &bench,
        &set("regulating_valve.plunger_mass_kg=0.1"),
        &["[regulating_valve]"],
    );
}

#[test]
fn controller_files_with_the_line_and_a_mark() {
    let bench = bench();
    check(
        &bench,
        &["control", "--controller", "gain.toml"],
        &[
            "gain.toml:",
            "= -40 is out of range: allowed 0.01 to 1000",
            " | gain_pct_per_bar = -40",
            "| ^^^^",
        ],
    );
    check(
        &bench,
        &["control", "--controller", "broken.toml"],
        &["broken.toml:1", "not valid TOML"],
    );
    // Defect seen: a misspelt bundled controller was a missing file.
    check(
        &bench,
        &["control", "--controller", "pulse"],
        &[
            "--controller pulse: there is no such file, and the bundled controllers are thesis, recommended, pulses",
        ],
    );
}

#[test]
fn logs() {
    let bench = bench();
    check(
        &bench,
        &["compare", "--log", "back.csv"],
        &["E-CSV-TIME-ORDER", "back.csv, line 4"],
    );
    check(
        &bench,
        &["simulate", "--log", "back.csv"],
        &["E-CSV-TIME-ORDER", "back.csv, line 4"],
    );
    check(
        &bench,
        &["simulate", "--log", "no-unit.csv"],
        &["no-unit.csv", "duty_fill"],
    );
    check(
        &bench,
        &["simulate", "--log", "no-duty.csv"],
        &["no-duty.csv", "duty_fill", "p_ch"],
    );
    check(
        &bench,
        &["compare", "--log", "no-duty.csv"],
        &["duty_fill", "p_ch"],
    );
    check(
        &bench,
        &["compare", "--log", "log.csv"],
        &["has no measured signal that the model has"],
    );
    check(
        &bench,
        &["simulate", "--log", "log.csv", "--mapping", "broken.toml"],
        &["broken.toml"],
    );
}

#[test]
fn references() {
    let bench = bench();
    check(
        &bench,
        &["control", "--reference", "low.csv"],
        &["low.csv", "15.5 bar gauge at 1 s is out of range"],
    );
    check(
        &bench,
        &["control", "--reference", "log.csv"],
        &["log.csv", "p_ref"],
    );
    check(
        &bench,
        &["control", "--scenario", "figure-9.9"],
        &["figure-9.9", "figure-6.5"],
    );
}

/// Defect seen: a misspelt column counted as 0 %, and `diagnose` then named an effect.
#[test]
fn commands_that_are_not_in_the_log() {
    let bench = bench();
    let log = beginning_of("synthetic/practice-00-id.csv", 5.0);
    bench
        .file(
            "misspelt.csv",
            &log.replace("duty_fill_pct", "duty_filll_pct"),
        )
        .file("renamed.csv", &log.replace("duty_vent_pct", "PWM2_pct"));
    let damaged = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/damaged-name.mf4");
    for command in [
        "simulate",
        "compare",
        "diagnose",
        "refine --add chamber_leak --out new.toml",
        "next-experiment --for chamber_leak",
        "report --without diagnosis",
    ] {
        for (log, expected) in [
            (
                "misspelt.csv",
                [
                    "misspelt.csv has no duty cycle `duty_fill`",
                    "is it duty_filll?",
                ],
            ),
            (
                "renamed.csv",
                ["renamed.csv has no duty cycle `duty_vent`", "is it PWM2?"],
            ),
            (
                damaged,
                ["damaged-name.mf4 has no duty cycle `duty_fill`", "is it l?"],
            ),
        ] {
            let mut arguments: Vec<&str> = command.split(' ').collect();
            arguments.extend(["--log", log]);
            check(&bench, &arguments, &expected);
        }
    }
    // A declared unit is not a guess.
    bench.file(
        "constant.toml",
        "schema = 1\n[signal.duty_fill]\ncolumn = \"duty_fill_pct\"\nunit = \"pct\"\n\
         [signal.pwm]\ncolumn = \"PWM2_pct\"\nunit = \"pct\"\n\
         [constant.duty_vent]\nvalue = 0\nunit = \"pct\"\n",
    );
    let declared = [
        "simulate",
        "--log",
        "renamed.csv",
        "--mapping",
        "constant.toml",
    ];
    bench.run(&declared).ended_with(0);
}

/// One mapping works for logs with and without a command.
#[test]
fn a_constant_is_added_where_the_log_does_not_have_it() {
    let bench = Bench::new();
    let [with, without, mapping] = [
        "practice-03-id.csv",
        "practice-03-scope-40.csv",
        "scope.toml",
    ]
    .map(|name| data(&format!("synthetic/{name}")));
    let simulate = |log: &str, more: &[&str]| {
        let arguments = [&["simulate", "--log", log, "--out", "m.csv"], more].concat();
        bench.run(&arguments)
    };
    let declared = ["--mapping", mapping.as_str()];
    let duties = |text: &str| {
        let rows = text
            .lines()
            .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        rows.filter(|row| row.split(',').nth(2) != Some("0"))
            .count()
    };
    simulate(&with, &declared).ended_with(0);
    assert!(duties(&bench.read("m.csv")) > 100);
    assert_eq!(simulate(&without, &[]).status, 2);
    simulate(&without, &declared).ended_with(0);
    assert_eq!(duties(&bench.read("m.csv")), 0);
}

/// Training data cannot validate a fit, under any name.
#[test]
fn the_same_log_twice() {
    let bench = bench();
    let log = beginning_of("synthetic/practice-00-id.csv", 5.0);
    bench.file("one.csv", &log).file("copy.csv", &log);
    for (other, said) in [
        (
            ["--check", "one.csv"],
            "a fit is not validated by what was fitted",
        ),
        (
            ["--check", "copy.csv"],
            "copy.csv has the same bytes as one.csv",
        ),
        (["--log", "copy.csv"], "fitted twice, it would count twice"),
    ] {
        let arguments = [&log_of("diagnose", "one.csv")[..], &other].concat();
        check(&bench, &arguments, &[said]);
    }
}

fn log_of<'a>(command: &'a str, log: &'a str) -> [&'a str; 3] {
    [command, "--log", log]
}

#[test]
fn options() {
    let bench = bench();
    let log = data("synthetic/practice-01-check.csv");
    let compare = |more: &[&'static str]| {
        let arguments = [&["compare", "--log", log.as_str()], more].concat();
        arguments.into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    for (more, expected) in [
        (
            &["--signal", "p_chamber"][..],
            &["`p_chamber`", "p_ch, i_fill, i_vent"][..],
        ),
        (
            &["--tolerance", "p_chamber=1"],
            &["\"p_chamber\"", "remove it or correct the name"],
        ),
        (&["--allow", "0"], &["allowed_noise_multiples", "positive"]),
        (
            &["--html", "no/such/folder/c.html"],
            &["no/such/folder/c.html"],
        ),
    ] {
        let arguments = compare(more);
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        check(&bench, &arguments, expected);
    }
    check(
        &bench,
        &["simulate", "--log", "log.csv", "--json"],
        &["two results for the standard output", "--out FILE"],
    );
    check(
        &bench,
        &["control", "--out", "-", "--json"],
        &["two results for the standard output", "--out FILE"],
    );
    let both = [&log_of("compare", &log)[..], &["--html", "-", "--json"]].concat();
    check(
        &bench,
        &both,
        &["two results for the standard output", "--html FILE"],
    );
    for (option, found) in [("--max-bar", "40.5"), ("--duration", "600.5")] {
        let plan = [
            &log_of("next-experiment", &log)[..],
            &["--for", "chamber_leak", option, found],
        ]
        .concat();
        let most = &found[..found.len() - 2];
        check(
            &bench,
            &plan,
            &[&format!("{found} is not above 0 and at most {most}")],
        );
    }
    check(&bench, &["simulte"], &["simulte", "simulate"]);
    check(&bench, &["compare"], &["<LOG>"]);
}

#[test]
fn effects_that_cannot_be_added() {
    let bench = bench();
    let log = data("synthetic/practice-01-check.csv");
    for (added, expected) in [
        (
            &["chamber_leek"][..],
            &["no effect `chamber_leek`, did you mean `chamber_leak`?"][..],
        ),
        (
            &["leaks"],
            &["no effect `leaks`; `retarder parameters` lists"],
        ),
        (
            &["leak"],
            &["no effect `leak`, did you mean `chamber_leak` or `supply_seat_leak`?"],
        ),
        (
            &["chamber_leak:square"],
            &["has no form `square`", "orifice, laminar, mixed, power"],
        ),
        (
            &["chamber_leak", "chamber_leak:laminar"],
            &["--add chamber_leak is there more than once"],
        ),
    ] {
        let adds = added.iter().flat_map(|effect| ["--add", effect]);
        let arguments: Vec<&str> = ["refine", "--log", &log, "--out", "p.toml"]
            .into_iter()
            .chain(adds)
            .collect();
        check(&bench, &arguments, expected);
    }
    let vessel = data("plants/air-vessel-790kPa.toml");
    check(
        &bench,
        &[
            "refine",
            "--plant",
            &vessel,
            "--log",
            &log,
            "--add",
            "coil_heating",
            "--out",
            "p.toml",
        ],
        &["the plant has no coil", "leave out --add coil_heating"],
    );
    check(
        &bench,
        &["diagnose", "--log", "absent.csv"],
        &["absent.csv", "check that the file exists"],
    );
    check(&bench, &["diagnose", "--log", "log.csv"], &["log.csv"]);
    check(
        &bench,
        &["refine", "--log", &log, "--add", "chamber_leak"],
        &["--out <FILE>"],
    );
}

#[test]
fn a_plant_without_valves_where_both_are_needed() {
    let bench = bench();
    let vessel = data("plants/air-vessel-790kPa.toml");
    for (command, missing) in [
        ("control", "fill valve that is commanded"),
        ("tune", "fill valve that is commanded"),
        ("thesis", "armature of the fill valve"),
    ] {
        check(
            &bench,
            &[command, "--plant", &vessel],
            &[
                &format!("air-vessel-790kPa.toml: the plant has no {missing}"),
                "needs both valves and the chamber",
            ],
        );
    }
    let log = data("real/leakdown-aluminium.csv");
    let chamber = data("plants/leakdown-chamber.toml");
    check(
        &bench,
        &[
            &log_of("next-experiment", &log)[..],
            &["--plant", &chamber, "--for", "chamber_leak"],
        ]
        .concat(),
        &[
            "the plant has no fill valve that is commanded",
            "planned for both valves and the chamber",
        ],
    );
    check(
        &bench,
        &[
            "parameters",
            "--plant",
            &vessel,
            "--set",
            "coil.resistance_20c_ohm=80",
        ],
        &[
            "--set",
            "`coil.resistance_20c_ohm` describes nothing, since this plant has no coil",
        ],
    );
}
