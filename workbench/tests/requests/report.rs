//! Report of a session: complete, self-contained, and with text from logs as text.

use serde_json::{Value, json};

use crate::bench::{Bench, Browser};

const HOSTILE: &str = "%3C%2Ftitle%3E%3Cscript%3Ealert(1)%3C%2Fscript%3E.csv";

fn write(browser: &Browser<'_>, session: &str) -> Value {
    let mut events = browser.work(session, &format!("{session}/report"), &json!({}));
    events.pop().unwrap()
}

#[test]
fn the_report_has_every_part_of_the_session() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    assert_eq!(
        browser.get(&format!("{session}/report/file")).code(),
        "E-WEB-TOO-EARLY"
    );
    browser.post(
        &format!("{session}/examples/practice-01"),
        &json!({"keep": false}),
    );
    browser.upload(&session, "broken.csv", b"time_s,p_ch_bar_gauge\n0,1\n0,2\n");
    browser.work(&session, &format!("{session}/control/run"), &json!({}));
    assert_eq!(write(&browser, &session)["state"], "done");
    let state = browser.get(&format!("{session}/report")).json();
    let expected = json!({
        "logs": 3, "unreadable": 1, "compared": 2, "has_diagnosis": false, "steps": 0, "runs": 1, "has_report": true,
    });
    assert_eq!(state, expected);
    let file = browser.get(&format!("{session}/report/file"));
    assert_eq!(
        file.header("content-disposition"),
        Some("attachment; filename=\"report.html\"")
    );
    let html = file.text();
    for part in [
        "practice-01-id.csv",
        "practice-01-check.csv",
        "broken.csv",
        "line 3",
        "nominal-plant.toml",
        "id=\"model-2\"",
        "scenario figure-6.5",
        "Requirements, and the worst",
        "recommended controller",
        "SHA-256",
        "<svg",
    ] {
        assert!(html.contains(part), "{part} is missing");
    }
    for forbidden in ["<script", "http://", "https://", "src=", "url("] {
        assert!(!html.contains(forbidden), "{forbidden}");
    }
    // The preview is the same document.
    let preview = browser.get(&format!("{session}/report/preview"));
    assert_eq!(preview.body, file.body);
    assert_eq!(preview.header("content-disposition"), None);
}

/// Rules 7 and 8: the report is a document that may run nothing, and names of a log are text in it.
#[test]
fn the_report_may_run_nothing_and_hostile_names_are_text() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let log = b"time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge,\"<img src=x onerror=alert(1)> [V]\"\n0,0,0,0,1\n0.01,50,0,0.1,1\n0.02,50,0,0.2,1\n";
    assert_eq!(browser.upload(&session, HOSTILE, log).status, 200);
    assert_eq!(write(&browser, &session)["state"], "done");
    for path in ["preview", "file"] {
        let answer = browser.get(&format!("{session}/report/{path}"));
        let policy = answer.header("content-security-policy").unwrap();
        for part in [
            "default-src 'none'",
            "style-src 'sha256-",
            "frame-ancestors 'self'",
            "sandbox;",
            "require-trusted-types-for 'script'",
        ] {
            assert!(policy.contains(part), "{policy}");
        }
        assert!(
            !policy.contains("unsafe") && !policy.contains("script-src"),
            "{policy}"
        );
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"));
        let html = answer.text();
        assert!(html.contains("&lt;img src=x onerror=alert(1)&gt;"));
        for markup in ["<script", "<img"] {
            assert!(!html.contains(markup), "{markup}");
        }
    }
}

#[test]
fn a_session_with_nothing_has_a_report_that_says_so() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    assert_eq!(write(&browser, &session)["state"], "done");
    let html = browser.get(&format!("{session}/report/file")).text();
    assert!(html.contains("nominal-plant.toml") && !html.contains("id=\"control\""));
}
