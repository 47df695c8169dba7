use std::io::{BufRead as _, BufReader};
use std::process::Stdio;

use model_lab::Comparison;

use crate::runner::{Bench, assert_contains, beginning_of, data};

#[test]
fn a_log_of_another_rig_does_not_hold_and_one_that_is_allowed_more_does() {
    let bench = Bench::new();
    let log = data("synthetic/practice-01-id.csv");
    let out = bench.run(&["compare", "--log", &log]).ended_with(1);
    assert_contains(
        &out,
        &["FAIL", "Where the error of p_ch is", "time in the log"],
    );
    let out = bench
        .run(&["compare", "--log", &log, "--allow", "100"])
        .ended_with(0);
    assert_contains(&out, &["Pass", "at most 100 times its noise floor"]);
}

/// The rig of practice-01 draws less current: with a higher resistance the modelled current fits better. The tolerance
/// excludes the pressure error from the verdict.
#[test]
fn tolerances_and_changed_parameters_count() {
    let bench = Bench::new();
    let log = data("synthetic/practice-01-id.csv");
    let compare = |more: &[&str]| {
        let arguments = [&["compare", "--log", &log, "--json"], more].concat();
        let ran = bench.run(&arguments);
        serde_json::from_str::<Comparison>(&ran.out).unwrap()
    };
    let nominal = compare(&["--tolerance", "p_ch=1"]);
    assert_eq!(nominal.verdict.failing, ["i_fill", "i_vent"]);
    let changed = compare(&["--set", "coil.resistance_20c_ohm=84.2"]);
    assert!(changed.signals[1].free_run.rms < 0.7 * nominal.signals[1].free_run.rms);
}

#[test]
fn json_is_a_comparison_of_the_library_and_goes_where_it_is_sent() {
    let bench = Bench::new();
    let log = data("synthetic/practice-01-id.csv");
    let on_standard_output = bench
        .run(&["compare", "--log", &log, "--json"])
        .ended_with(1);
    let out = bench
        .run(&[
            "compare", "--log", &log, "--json", "c.json", "--html", "c.html",
        ])
        .ended_with(1);
    assert_contains(&out, &["Written: c.json", "Written: c.html"]);
    assert_eq!(bench.read("c.json"), on_standard_output);
    // The type refuses unknown fields.
    let comparison: Comparison = serde_json::from_str(&on_standard_output).unwrap();
    assert_eq!(comparison.schema, "retarder.comparison/2");
    assert!(bench.read("c.html").contains("retarder compare --log"));
}

/// Defect seen: a file with the name `-` was created.
#[test]
fn a_page_goes_to_the_standard_output_in_place_of_the_text() {
    let bench = Bench::new();
    let log = data("synthetic/practice-01-check.csv");
    let without = ["--without", "diagnosis", "--without", "control"];
    for arguments in [
        &["compare", "--log", &log, "--html", "-"][..],
        &[&["report", "--log", &log, "--out", "-"][..], &without].concat(),
    ] {
        let out = bench.run(arguments).ended_with(1);
        assert!(out.starts_with("<!DOCTYPE html>"), "{out:.80}");
        assert!(out.trim_end().ends_with("</html>"));
        assert_eq!(bench.files(), [""; 0], "{arguments:?}");
    }
}

#[test]
fn a_verdict_that_cannot_be_given_is_neither_yes_nor_no() {
    let bench = Bench::new();
    // Always energised: no interval shows the noise.
    let rows: String = (0..100)
        .map(|row| format!("{:.2},60,0,{}\n", f64::from(row) * 0.01, row % 7))
        .collect();
    bench.file(
        "busy.csv",
        &format!("time_s,duty_fill_pct,duty_vent_pct,i_fill_mA\n{rows}"),
    );
    let ran = bench.run(&["compare", "--log", "busy.csv"]);
    assert_contains(&ran.out, &["No verdict", "--tolerance i_fill=RMS"]);
    assert_eq!(ran.status, 2);
}

#[test]
fn a_mapping_explains_a_file_of_the_wild() {
    let bench = Bench::new();
    bench.file(
        "wild.csv",
        "0;0;0,5\n10;0;0,5\n20;60;0,5\n30;60;0,5\n40;0;0,6\n50;0;0,7\n",
    );
    bench.file(
        "wild.toml",
        "schema = 1\n[dialect]\nheader = false\ndecimal = \",\"\ndelimiter = \"semicolon\"\n\
         [time]\ncolumn = 1\nunit = \"ms\"\n[signal.duty_fill]\ncolumn = 2\nunit = \"pct\"\n\
         [signal.p_ch]\ncolumn = 3\nunit = \"bar_gauge\"\nscale = 0.5\noffset = -0.25\n\
         [constant.duty_vent]\nvalue = 0\nunit = \"pct\"\n",
    );
    let out = bench
        .run(&[
            "compare",
            "--log",
            "wild.csv",
            "--mapping",
            "wild.toml",
            "--tolerance",
            "p_ch=0.2",
        ])
        .ended_with(0);
    assert_contains(&out, &["6 samples, 0.05 s", "p_ch [bar]"]);
}

#[test]
fn a_reader_who_has_seen_enough_does_not_change_the_answer() {
    let bench = Bench::new();
    let mut child = bench
        .command(&["compare", "--log", &data("synthetic/practice-01-id.csv")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut err = String::new();
    BufReader::new(child.stderr.take().unwrap())
        .read_line(&mut err)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(err, "");
}

/// The signs are unambiguous, and no model fits such a log.
#[test]
fn swapped_valves_and_a_column_of_another_name_are_reported_in_text_and_json() {
    let bench = Bench::new();
    let log = beginning_of("synthetic/practice-00-id.csv", 10.0);
    bench
        .file(
            "swapped.csv",
            &log.replace("duty_fill_pct,duty_vent_pct", "duty_vent_pct,duty_fill_pct"),
        )
        .file(
            "renamed.csv",
            &log.replace("p_ch_bar_gauge", "pressure_bar_gauge"),
        );
    for (log, kind, said) in [
        (
            "swapped.csv",
            "swapped_valves",
            &[
                "p_ch falls while only the fill valve is commanded",
                "swapped?",
            ],
        ),
        (
            "renamed.csv",
            "unknown_signal",
            &["pressure is no signal of the model", "is it p_ch?"],
        ),
    ] {
        let arguments = [
            "compare", "--log", log, "--json", "c.json", "--html", "c.html",
        ];
        let ran = bench.run(&arguments);
        let out = ran.out.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_contains(&out, said);
        assert_contains(&bench.read("c.json"), &[kind]);
        assert_contains(
            &bench.read("c.html"),
            &["<strong>Warning</strong>", said[0]],
        );
    }
}
