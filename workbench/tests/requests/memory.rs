//! A tab that needs too much memory ends alone: the server, the other tabs and stored data remain.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::bench::{Bench, Browser, worker};

/// Enough for a tab with a small log.
const LITTLE: u64 = 96 << 20;

const SMALL: &[u8] = b"time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge\n0,0,0,0\n0.01,50,0,0.1\n0.02,50,0,0.2\n0.03,0,0,0.2\n";

/// Returns a log for a tab with little memory. Its units differ from those of the model, so that a comparison converts
/// them.
fn log(rows: usize) -> Vec<u8> {
    let mut text = "time_s,duty_fill_pct,duty_vent_pct,p_ch_kPa_abs,i_fill_A\n".to_owned();
    for row in 0..rows {
        let duty = if row % 400 < 100 { 60 } else { 0 };
        // Writing to a String cannot fail.
        let (time_s, saw) = (row as f64 * 0.001, row % 7);
        let _ = writeln!(text, "{time_s:.3},{duty},0,{},0.{saw}", 101 + saw);
    }
    text.into_bytes()
}

fn names(browser: &Browser<'_>, session: &str) -> Vec<Value> {
    let project = browser.get(&format!("{session}/project")).json();
    let logs = project["logs"].as_array();
    let logs = logs.unwrap_or_else(|| panic!("{project}")).iter();
    logs.map(|log| log["name"].clone()).collect()
}

/// Defect seen: the server ended with all tabs when reading a log took more memory than the machine had.
#[test]
fn a_log_that_takes_too_much_memory_is_reported_and_can_be_removed() {
    let bench = Bench::with_worker(worker(LITTLE));
    let browser = bench.browser();
    let (other, session) = (browser.session(None), browser.session(None));
    browser.upload(&other, "other.csv", SMALL);
    browser.upload(&session, "small.csv", SMALL);
    let refused = browser.upload(&session, "large.csv", &log(2_000_000));
    assert_eq!(
        (refused.status, refused.code()),
        (500, "E-WEB-MEMORY".to_owned())
    );
    assert!(refused.text().contains("96 MiB"), "{}", refused.text());
    // Another process has the project, and returns the problem of the log instead of reading it again.
    let project = browser.get(&format!("{session}/project")).json();
    let problems: Vec<&Value> = project["logs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|log| &log["problem"]["code"])
        .collect();
    assert_eq!(problems, [&Value::Null, &json!("E-WEB-MEMORY")]);
    assert_eq!(names(&browser, &other), ["other.csv"]);
    let left = browser.send("DELETE", &format!("{session}/logs/2"), "text/plain", b"");
    assert_eq!(left.json()["logs"].as_array().unwrap().len(), 1);
    assert_eq!(browser.compare(&session, 1)["state"], "done");
}

/// A job also fails alone: the log can be read, but the comparison needs more memory.
#[test]
fn a_job_that_takes_too_much_memory_fails_alone() {
    let bench = Bench::with_worker(worker(LITTLE));
    let browser = bench.browser();
    let (other, session) = (browser.session(None), browser.session(None));
    browser.upload(&other, "other.csv", SMALL);
    assert_eq!(browser.compare(&other, 1)["state"], "done");
    let added = browser.upload(&session, "long.csv", &log(MOST_ROWS));
    assert_eq!(added.status, 200, "{added:?}");
    let ended = browser.compare(&session, 1);
    assert_eq!(ended["state"], "failed", "{ended}");
    assert_eq!(ended["problems"][0]["code"], "E-WEB-MEMORY");
    assert_eq!(names(&browser, &session), ["long.csv"]);
    // The result of the other tab is still there.
    let kept = browser.get(&format!("{other}/logs/1/comparison"));
    assert_eq!(kept.status, 200);
}

/// Rows of a log that can be read but not compared. Half a million can be compared; a million cannot always be read.
const MOST_ROWS: usize = 750_000;

/// Defect seen: mappings that requested 103 GB. Now they are refused or read, or end their own tab's process.
#[test]
fn hostile_mappings_do_not_end_the_server() {
    let bench = Bench::with_worker(worker(4 * LITTLE));
    let browser = bench.browser();
    let (other, session) = (browser.session(None), browser.session(None));
    browser.upload(&other, "other.csv", SMALL);
    let log = include_bytes!("hostile/bench.csv");
    assert_eq!(browser.upload(&session, "bench.csv", log).status, 200);
    for mapping in [
        include_str!("hostile/map_2_2005_m.toml"),
        include_str!("hostile/map_2_203_m.toml"),
        include_str!("hostile/map_2_3248_m.toml"),
        include_str!("hostile/map_2_4611_m.toml"),
    ] {
        let path = format!("{session}/logs/1/mapping");
        let mapped = browser.put(&path, &json!({ "toml": mapping }));
        assert!(matches!(mapped.status, 200 | 422), "{mapped:?}");
        let ended = browser.compare(&session, 1);
        assert!(
            ended["state"] == "done" || ended["problems"][0]["code"].is_string(),
            "{ended}"
        );
        for path in ["refine?log=1", "logs/1/traces?points=100", "logs/1/preview"] {
            let answer = browser.get(&format!("{session}/{path}"));
            assert!(
                answer.status == 200 || answer.code().starts_with("E-"),
                "{path}: {answer:?}"
            );
        }
        assert_eq!(names(&browser, &session), ["bench.csv"]);
    }
    assert_eq!(names(&browser, &other), ["other.csv"]);
}
