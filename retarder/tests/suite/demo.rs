use crate::runner::{Bench, assert_contains};

#[test]
fn the_demo_shows_comparison_loop_and_next_steps_and_writes_a_report_that_loads_nothing() {
    let bench = Bench::new();
    let out = bench.run(&[]).ended_with(0);
    assert_contains(
        &out,
        &[
            "practice-01-id.csv",
            "p_ch [bar]",
            "valves",
            "measured - modelled [bar]",
            "Outside tolerance",
            "This is expected",
            "Required by the thesis",
            "vent 0.88 to 0.71 p_sup",
            "report.html",
            "retarder compare --log",
        ],
    );
    assert_eq!(bench.files(), ["report.html"]);
    let report = bench.read("report.html");
    assert_contains(&report, &["<svg", "</html>", "practice-01-id.csv"]);
    for loading in ["<script", "src=\"http", "href=\"http", "url(http"] {
        assert!(!report.contains(loading), "{loading}");
    }
}

#[test]
fn text_fits_into_80_and_120_columns_and_is_plain_where_there_is_no_terminal() {
    let bench = Bench::new();
    for columns in [80, 120] {
        let mut command = bench.command(&[]);
        let output = command
            .env("COLUMNS", columns.to_string())
            .output()
            .unwrap();
        let out = String::from_utf8(output.stdout).unwrap();
        let too_wide = out.lines().find(|line| line.chars().count() > columns);
        assert_eq!(too_wide, None);
        assert!(!out.contains('\u{1b}'));
    }
}

#[test]
fn colours_are_shown_when_forced_and_never_when_refused() {
    let bench = Bench::new();
    let coloured = |name: &str| {
        let output = bench
            .command(&["settings"])
            .env(name, "1")
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap().contains('\u{1b}')
    };
    assert!(coloured("CLICOLOR_FORCE"));
    assert!(!coloured("NO_COLOR"));
}
