//! Tabs, restarts, and jobs whose page has closed.

use std::io::Read;

use serde_json::{Value, json};

use crate::bench::{Bench, Browser};

fn names(browser: &Browser<'_>, session: &str) -> Vec<String> {
    let project = browser.get(&format!("{session}/project")).json();
    let logs = project["logs"].as_array().unwrap().iter();
    logs.map(|log| log["name"].as_str().unwrap().to_owned())
        .collect()
}

const LOG: &[u8] = b"time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge\n0,0,0,0\n0.01,50,0,0.1\n0.02,50,0,0.2\n0.03,0,0,0.2\n";

#[test]
fn two_tabs_do_not_disturb_each_other() {
    let bench = Bench::start();
    let browser = bench.browser();
    let (one, other) = (browser.session(None), browser.session(None));
    assert_ne!(one, other);
    browser.upload(&one, "one.csv", LOG);
    assert_eq!(names(&browser, &other), [""; 0]);
    browser.upload(&other, "other.csv", LOG);
    browser.put(
        &format!("{other}/strictness"),
        &json!({"allowed_noise_multiples": 9.0, "tolerances": {}}),
    );
    assert_eq!(names(&browser, &one), ["one.csv"]);
    let project = browser.get(&format!("{one}/project")).json();
    assert_eq!(project["strictness"]["allowed_noise_multiples"], 1.5);
    // A duplicated tab requests the same project, and gets a copy.
    let id = one.rsplit('/').next().unwrap();
    let copy = browser.session(Some(id));
    assert_ne!(copy, one);
    assert_eq!(names(&browser, &copy), ["one.csv"]);
    browser.send("DELETE", &format!("{copy}/project"), "text/plain", b"");
    assert_eq!(names(&browser, &one), ["one.csv"]);
}

/// The page shows a user who opens a second tab that both are separate, but not one who reloads it or opens the first.
#[test]
fn a_session_says_whether_it_began_as_a_copy() {
    let bench = Bench::start();
    let browser = bench.browser();
    let open = |wanted: Option<&str>| {
        let opened = browser.post("/api/sessions", &json!({ "project": wanted }));
        let opened = opened.json();
        let id = opened["session"].as_str().unwrap().to_owned();
        (id, opened["is_copy"].as_bool().unwrap())
    };
    let (first, is_copy) = open(None);
    assert!(!is_copy, "nothing was open");
    browser.upload(&format!("/api/sessions/{first}"), "one.csv", LOG);
    assert!(open(None).1, "a new tab");
    assert!(open(Some(&first)).1, "a tab that was duplicated");
    browser.post(&format!("/api/sessions/{first}/close"), &json!({}));
    assert_eq!(open(Some(&first)), (first, false), "loaded again");
}

/// A restart has another token, and finds each tab's project, its logs and its offsets; a new tab begins with the last
/// one.
#[test]
fn a_restart_finds_the_projects_again() {
    let bench = Bench::start();
    let (first, last) = {
        let browser = bench.browser();
        let (first, last) = (browser.session(None), browser.session(None));
        browser.upload(&first, "first.csv", LOG);
        browser.put(
            &format!("{first}/logs/1/offset"),
            &json!({"offset_s": 0.25}),
        );
        browser.upload(&last, "last.csv", b"time_s,p_ch_bar_gauge\n0,1\n1,2\n");
        (first, last)
    };
    let old_cookie = bench.token.clone();
    let bench = bench.restart();
    assert_ne!(bench.token, old_cookie);
    let browser = bench.browser();
    assert_eq!(
        browser.get(&format!("{first}/project")).status,
        404,
        "sessions end with the server"
    );
    let id = first.rsplit('/').next().unwrap();
    let again = browser.session(Some(id));
    assert_eq!(again, first, "the tab has its project under its own name");
    let project = browser.get(&format!("{again}/project")).json();
    assert_eq!(project["logs"][0]["name"], "first.csv");
    assert_eq!(project["logs"][0]["offset_s"], 0.25);
    assert_eq!(project["logs"][0]["problem"], Value::Null);
    let fresh = browser.session(None);
    assert_ne!(fresh, last);
    assert_eq!(names(&browser, &fresh), ["last.csv"]);
}

#[test]
fn a_project_file_that_is_broken_is_a_new_project() {
    let bench = Bench::start();
    let session = {
        let browser = bench.browser();
        let session = browser.session(None);
        browser.upload(&session, "one.csv", LOG);
        session
    };
    let id = session.rsplit('/').next().unwrap().to_owned();
    let file = bench
        .folder
        .path()
        .join("projects")
        .join(format!("{id}.json"));
    for text in ["", "{", "{\"schema\": 7}", "[]", &"[".repeat(100_000)] {
        std::fs::write(&file, text).unwrap();
        let browser_bench = Bench::start();
        std::fs::copy(
            &file,
            browser_bench
                .folder
                .path()
                .join("projects")
                .join(format!("{id}.json")),
        )
        .unwrap();
        let browser = browser_bench.browser();
        let opened = browser.session(Some(&id));
        assert_eq!(names(&browser, &opened), [""; 0]);
    }
}

/// Rule 11: a closed session is gone, with its job.
#[test]
fn closing_a_page_ends_its_session_and_its_work() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    browser.post(
        &format!("{session}/examples/practice-01"),
        &json!({"keep": false}),
    );
    let begun = browser.post(&format!("{session}/logs/1/compare"), &json!({}));
    let job = begun.json()["job"].as_u64().unwrap();
    let mut events = browser.follow(&session, job);
    assert_eq!(
        browser.post(&format!("{session}/close"), &json!({})).status,
        200
    );
    let mut rest = String::new();
    events.read_to_string(&mut rest).unwrap();
    assert!(rest.contains(r#"{"state":"cancelled"}"#), "{rest}");
    assert_eq!(browser.get(&format!("{session}/project")).status, 404);
}

#[test]
fn a_second_job_of_a_tab_takes_the_place_of_the_first() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    browser.post(
        &format!("{session}/examples/practice-02"),
        &json!({"keep": false}),
    );
    let first = browser
        .post(&format!("{session}/logs/1/compare"), &json!({}))
        .json()["job"]
        .clone();
    let ended = browser.compare(&session, 2);
    assert_eq!(ended["state"], "done");
    assert_eq!(browser.get(&format!("{session}/jobs/{first}")).status, 404);
    assert_eq!(
        browser.get(&format!("{session}/logs/1/comparison")).code(),
        "E-WEB-TOO-EARLY"
    );
    assert_eq!(
        browser.get(&format!("{session}/logs/2/comparison")).json()["schema"],
        "retarder.comparison/2"
    );
}
