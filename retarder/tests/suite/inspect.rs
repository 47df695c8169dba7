//! Logs of unknown layout: what `inspect` shows, and that the commands that it proposes work.

use crate::runner::{Bench, assert_contains, beginning_of, data, short_log};

/// Writes a log as a German logger does: preamble, row of units, decimal commas, a column of texts.
fn german(bench: &Bench, name: &str, unit_of_pressure: &str) {
    let source = beginning_of("synthetic/practice-01-id.csv", 6.0);
    let rows = source.lines().filter(|line| !line.starts_with(['#', 't']));
    let rows = rows.map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{};{};{};{};ok\n", cells[0], cells[3], cells[1], cells[2]).replace('.', ",")
    });
    let head = format!(
        "Messung;Retarder 7\n\nZeit;Kammerdruck;Füllventil;Entlüftungsventil;Bemerkung\ns;{unit_of_pressure};%;%;\n"
    );
    bench.file(name, &(head + &rows.collect::<String>()));
}

/// Returns the commands below `Next:`.
fn next(out: &str) -> Vec<Vec<String>> {
    let lines = out.lines().skip_while(|line| *line != "Next:").skip(1);
    let lines = lines.take_while(|line| line.starts_with("  retarder "));
    lines
        .map(|line| line.split_whitespace().skip(1).map(str::to_owned).collect())
        .collect()
}

/// Runs the proposed command.
fn follow(bench: &Bench, command: &[String], status: i32) -> String {
    let command: Vec<&str> = command.iter().map(String::as_str).collect();
    bench.run(&command).ended_with(status)
}

#[test]
fn the_proposed_commands_lead_from_an_unknown_log_to_a_comparison() {
    let bench = Bench::new();
    german(&bench, "bench.csv", "bar");
    let out = bench.run(&["inspect", "bench.csv"]).ended_with(2);
    assert_contains(
        &out,
        &[
            "bench.csv: CSV, separated by semicolon, decimal comma, header, units row",
            "name contains `kammer` and",
            "neither gauge nor absolute",
            "Answer: --pressure gauge",
            "[signal.p_ch]\ncolumn = \"Kammerdruck\"\nunit = \"bar\"",
        ],
    );
    let out = follow(&bench, &next(&out)[0], 0);
    assert_contains(&out, &["Written: bench-columns.toml"]);
    assert_contains(
        &bench.read("bench-columns.toml"),
        &[
            "skip_lines = 2",
            "ignore = [\"Bemerkung\"]",
            "unit = \"bar_gauge\"",
        ],
    );
    assert_eq!(bench.files(), ["bench-columns.toml", "bench.csv"]);
    let out = follow(&bench, &next(&out)[0], 1);
    assert_contains(&out, &["p_ch [bar]", "FAIL"]);
}

#[test]
fn the_logs_of_other_loggers_come_in_with_one_answer() {
    for name in ["german-logger", "unnamed-columns"] {
        let bench = Bench::new();
        let log = data(&format!("unknown/{name}.csv"));
        let out = bench.run(&["inspect", &log]).ended_with(2);
        let out = follow(&bench, &next(&out)[0], 0);
        assert_contains(&out, &[&format!("--mapping {name}-columns.toml")]);
        let ran = bench.run(&[
            "compare",
            &log,
            "--mapping",
            &format!("{name}-columns.toml"),
        ]);
        assert_contains(&ran.out, &["600 samples, 5.99 s", "p_ch [bar]"]);
    }
}

#[test]
fn the_standard_input_is_inspected_like_a_file() {
    let bench = Bench::new();
    german(&bench, "bench.csv", "barü");
    let of_file = bench.run(&["inspect", "bench.csv", "--json"]).ended_with(0);
    let ran = bench.run_reading(&["inspect", "-", "--json"], "bench.csv");
    assert_eq!(
        ran.ended_with(0),
        of_file.replace("bench.csv", "standard input")
    );
    let ran = bench.run_reading(&["inspect", "-"], "bench.csv");
    assert_contains(
        &ran.ended_with(0),
        &["  retarder inspect - --out log-columns.toml\n"],
    );
    let ran = bench.run_reading(&["inspect", "-", "-"], "bench.csv");
    assert_eq!(ran.status, 2);
    assert_contains(&ran.err, &["standard input is read once"]);
    assert_eq!(bench.files(), ["bench.csv"]);
}

#[test]
fn a_file_that_needs_no_mapping_says_so_and_leaves_no_file() {
    let bench = Bench::new();
    bench.file(
        "bench.csv",
        &beginning_of("synthetic/practice-01-id.csv", 3.0),
    );
    let out = bench
        .run(&["inspect", "bench.csv", "--out", "m.toml"])
        .ended_with(0);
    assert_contains(
        &out,
        &[
            "The file needs no mapping.",
            "  retarder compare bench.csv\n",
        ],
    );
    assert_eq!(bench.files(), ["bench.csv"]);
}

#[test]
fn several_logs_share_a_mapping_only_if_it_is_the_same() {
    let bench = Bench::new();
    german(&bench, "one.csv", "barü");
    german(&bench, "two.csv", "barü");
    german(&bench, "other.csv", "bar abs");
    let out = bench
        .run(&["inspect", "one.csv", "two.csv", "--out", "m.toml"])
        .ended_with(0);
    assert_contains(&out, &["one.csv: CSV", "two.csv: CSV", "Written: m.toml"]);
    let ran = bench.run(&["inspect", "one.csv", "other.csv", "--out", "n.toml"]);
    assert_eq!(ran.status, 2);
    assert_contains(
        &ran.err,
        &["one.csv and other.csv: the logs need different mappings"],
    );
    assert_eq!(bench.files(), ["m.toml", "one.csv", "other.csv", "two.csv"]);
}

#[test]
fn an_mf4_file_is_inspected_and_its_open_pressure_answered() {
    let bench = Bench::new();
    let log = "../recording/tests/fixtures/mf4/rates-transposed.mf4";
    let out = bench.run(&["inspect", &data(log)]).ended_with(2);
    assert_contains(
        &out,
        &["MF4, version 4.", "p_sup", "neither gauge nor absolute"],
    );
    let out = bench.run(&["inspect", &data(log), "--pressure", "absolute"]);
    assert_contains(&out.out, &["bar_abs", "The file needs no mapping."]);
}

#[test]
fn the_log_is_given_with_or_without_its_option() {
    let bench = Bench::new();
    bench.file(
        "bench.csv",
        &beginning_of("synthetic/practice-01-id.csv", 3.0),
    );
    let with_option = bench.run(&["compare", "--log", "bench.csv"]);
    let without = bench.run(&["compare", "bench.csv"]);
    assert_eq!(
        (with_option.status, &with_option.out),
        (without.status, &without.out)
    );
    let ran = bench.run(&["compare", "bench.csv", "--log", "bench.csv"]);
    assert_contains(&ran.err, &["cannot be used with"]);
    bench
        .run(&["simulate", "bench.csv", "--out", "model.csv"])
        .ended_with(0);
    // A log and a result must not be the same file, in whichever way the log is given.
    let ran = bench.run(&["simulate", "bench.csv", "--out", "bench.csv"]);
    assert_contains(
        &ran.err,
        &["bench.csv: --out names the file that LOG reads"],
    );
}

#[test]
fn a_reference_completes_bar_and_does_not_override_a_stated_one() {
    let bench = Bench::new();
    let log = beginning_of("synthetic/practice-01-id.csv", 3.0);
    let bar = log.replace("p_ch_bar_gauge", "p_ch_bar");
    bench.file("stated.csv", &log).file("bar.csv", &bar);
    let ran = bench.run(&["compare", "bar.csv"]);
    assert_eq!(ran.status, 2);
    assert_contains(
        &ran.err,
        &[
            "E-CSV-PRESSURE-REFERENCE: bar.csv, line",
            "--pressure gauge",
            "retarder inspect bar.csv",
        ],
    );
    let result = |log: &str, reference: &str| {
        let out = bench.run(&["compare", log, "--pressure", reference]).out;
        out.lines()
            .skip(1)
            .map(|line| format!("{line}\n"))
            .collect::<String>()
    };
    assert_eq!(result("bar.csv", "gauge"), result("stated.csv", "gauge"));
    assert_eq!(
        result("stated.csv", "absolute"),
        result("stated.csv", "gauge")
    );
    assert_ne!(result("bar.csv", "absolute"), result("bar.csv", "gauge"));
}

#[test]
fn bad_rows_are_skipped_where_that_is_asked_for_and_listed() {
    let bench = Bench::new();
    let log = beginning_of("synthetic/practice-01-id.csv", 3.0);
    bench.file("bench.csv", &log.replacen("\n0.1", "\nbroken\n0.1", 1));
    let ran = bench.run(&["compare", "bench.csv"]);
    assert_contains(&ran.err, &["E-CSV-RAGGED"]);
    let out = bench.run(&["inspect", "bench.csv"]).ended_with(1);
    assert_eq!(
        next(&out)[0],
        ["inspect", "bench.csv", "--skip-bad-rows", "1"]
    );
    let out = follow(&bench, &next(&out)[0], 0);
    assert_contains(&out, &["is skipped: found 1 fields"]);
    let compare = &next(&out)[0];
    assert_eq!(
        compare[..],
        ["compare", "bench.csv", "--skip-bad-rows", "1"]
    );
    let compare: Vec<&str> = compare.iter().map(String::as_str).collect();
    assert_contains(&bench.run(&compare).out, &["is skipped: found 1 fields"]);
    let ran = bench.run(&[
        "simulate",
        "bench.csv",
        "--skip-bad-rows",
        "1",
        "--out",
        "model.csv",
    ]);
    assert_contains(&ran.err, &["is skipped: found 1 fields"]);
}

#[test]
fn an_error_of_columns_names_the_inspection() {
    let bench = Bench::new();
    bench.file("it's.csv", "Zeit;Druck\n0,0;1,5\n0,1;1,6\n");
    let ran = bench.run(&["compare", "it's.csv"]);
    assert_eq!(ran.status, 2);
    assert_contains(
        &ran.err,
        &[
            "E-CSV-UNIT-MISSING",
            "`retarder inspect 'it'\\''s.csv'` lists the columns",
        ],
    );
}

#[test]
fn files_in_each_others_place_are_named_with_the_corrected_command() {
    let bench = Bench::new();
    let plant = bench.run(&["parameters", "--toml"]).ended_with(0);
    bench
        .file("plant.toml", &plant)
        .file("bench.csv", &short_log());
    bench.file(
        "columns.toml",
        "schema = 1\n[time]\ncolumn = 1\nunit = \"s\"\n",
    );
    let check = |arguments: &[&str], parts: &[&str]| {
        let ran = bench.run(arguments);
        assert_eq!(ran.status, 2, "{}", ran.out);
        assert_contains(&ran.err, parts);
    };
    check(
        &["compare", "--plant", "bench.csv", "--log", "plant.toml"],
        &[
            "bench.csv: --plant expects a plant file (TOML), and this is a log",
            "\n  retarder compare --log bench.csv --plant plant.toml\n",
        ],
    );
    check(
        &["compare", "--plant", "bench.csv"],
        &["this is a log", "\n  retarder compare --log bench.csv\n"],
    );
    bench.file(
        "sheet.toml",
        "rig = \"two valves\"\nchamber_volume_cm3 = 75   # tape measure, ±15 %\n",
    );
    check(
        &["compare", "--plant", "sheet.toml", "--log", "bench.csv"],
        &[
            "sheet.toml: --plant expects a plant file, and this file has the keys of a data sheet",
            "\n  retarder parameters --from-datasheet sheet.toml > my-plant.toml\n",
        ],
    );
    check(
        &["diagnose", "plant.toml", "bench.csv"],
        &[
            "plant.toml: a log is expected",
            "\n  retarder diagnose bench.csv --plant plant.toml\n",
        ],
    );
    check(
        &[
            "simulate",
            "bench.csv",
            "--plant",
            "plant.toml",
            "--log",
            "columns.toml",
        ],
        &["cannot be used with"],
    );
    check(
        &["inspect", "columns.toml"],
        &["this is a mapping (TOML)", "--mapping columns.toml"],
    );
}
