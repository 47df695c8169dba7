use super::*;
use crate::requirement::{BothValves, Reading};

#[test]
fn the_file_of_the_thesis_is_the_default_and_has_every_key() {
    assert_eq!(
        read(THESIS_TOML, "thesis.toml").unwrap(),
        Requirement::THESIS
    );
    for key in KEYS {
        let line = THESIS_TOML.lines().find(|line| {
            line.trim_start_matches("# ")
                .starts_with(&format!("{} = ", key.name))
        });
        assert!(
            line.is_some_and(|line| line.contains('#')),
            "{}",
            key.path()
        );
    }
    assert_eq!(read("", "empty.toml").unwrap(), Requirement::THESIS);
}

#[test]
fn every_key_changes_the_requirement() {
    for key in KEYS {
        let number = |share: f64, min: f64, max: f64| format!("{}", min + share * (max - min));
        // Of two values that must be in order, one allows a large number and the other a small one.
        let values = [0.6, 0.9].map(|share| match key.kind {
            keys::Kind::Number(min, max) => number(share, min, max),
            keys::Kind::Whole(min, max) => format!("{}", (min + max) / 2),
            keys::Kind::Word(words) => format!("\"{}\"", words[1]),
            keys::Kind::Flag => "true".to_owned(),
        });
        let changed = values.iter().filter(|value| {
            let text = format!("[{}]\n{} = {value}\n", key.table, key.name);
            read(&text, "changed.toml").is_ok_and(|found| found != Requirement::THESIS)
        });
        assert!(changed.count() > 0, "{}", key.path());
    }
}

#[test]
fn words_choose_the_reading_and_the_rule() {
    let text = "[vent]\ncounted_from = \"step\"\nends = \"at_level\"\n[valves]\nboth_energised = \"allowed\"\n\
                [lifts]\nmean_per_s = 1.5\n";
    let requirement = read(text, "mine.toml").unwrap();
    let reading = Reading {
        with_dead_time: true,
        to_level: true,
    };
    assert_eq!(
        (requirement.vent_reading, requirement.fill_reading),
        (reading, Requirement::THESIS.fill_reading)
    );
    assert_eq!(requirement.both_valves, BothValves::Allowed);
    assert_eq!(requirement.lifts_per_s, Some(1.5));
}

#[test]
fn an_error_names_file_line_value_bound_and_remedy() {
    for (text, expected) in [
        (
            "[settling]\np_tol_bar = 0\n",
            "mine.toml:2: `settling.p_tol_bar` = 0 is out of range; write a number from 0.001 to 5 (P_tol",
        ),
        (
            "[settling]\n\nt_req_samples = 50.5\n",
            "mine.toml:3: `settling.t_req_samples` = 50.5; write a whole number from 1 to 100000",
        ),
        (
            "[settling]\np_tol_bar = nan\n",
            "mine.toml:2: `settling.p_tol_bar` = NaN is out of range",
        ),
        (
            "[settling]\ntolerance = 1\n",
            "mine.toml:2: unknown key `settling.tolerance`; [settling] has the keys t_req_samples, p_tol_bar",
        ),
        (
            "[speed]\nfill = 1\n",
            "mine.toml:1: unknown table [speed]; a requirements file has the tables [settling], [overshoot]",
        ),
        ("p_tol_bar = 1\n", "mine.toml:1: unknown table [p_tol_bar]"),
        (
            "[fill]\ncounted_from = \"now\"\n",
            "mine.toml:2: `fill.counted_from` = \"now\"; write \"first_motion\" or \"step\"",
        ),
        (
            "[overshoot]\nbinding = 1\n",
            "mine.toml:2: `overshoot.binding` = 1; write true or false",
        ),
        (
            "[vent]\nfrom_psup = 0.5\n",
            "mine.toml:2: `vent.to_psup` = 0.71 is not below `vent.from_psup` = 0.5; change one of them",
        ),
        ("[vent\n", "mine.toml:1: not valid TOML"),
    ] {
        let error = read(text, "mine.toml").unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn every_problem_is_named_at_once_in_the_order_of_the_file() {
    let text = "[fill]\nto_psup = 2\nsoon = 1\n[other]\n";
    let error = read(text, "mine.toml").unwrap_err();
    let lines: Vec<usize> = error.problems().iter().map(Problem::line).collect();
    assert_eq!(lines, [2, 3, 4]);
    assert_eq!(error.to_string().lines().count(), 3);
}
