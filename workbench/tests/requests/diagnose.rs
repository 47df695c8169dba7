//! Page "Diagnose": from a log to the missing effect, and the end of jobs whose page has closed.

use std::io::Read as _;

use plant_sim::effects::LIBRARY;
use serde_json::{Value, json};

use crate::bench::{Bench, Browser};

const ID: &str = include_str!("../../../data/synthetic/practice-01-id.csv");

/// Returns the first seconds of the rig with a leak: enough for the diagnosis, and fast.
pub(crate) fn leaking(seconds: f64) -> String {
    let is_early = |line: &&str| {
        let time = line
            .split(',')
            .next()
            .and_then(|time| time.parse::<f64>().ok());
        time.is_none_or(|time| time < seconds)
    };
    ID.lines()
        .take_while(is_early)
        .map(|line| format!("{line}\n"))
        .collect()
}

/// Returns a session with the beginning of that log.
pub(crate) fn with_leaking_log(browser: &Browser<'_>, seconds: f64) -> String {
    let session = browser.session(None);
    let added = browser.upload(&session, "bench.csv", leaking(seconds).as_bytes());
    assert_eq!(added.status, 200, "{added:?}");
    session
}

/// Goal: the workflow of the page. Method: diagnose ten seconds of the rig with a leak, plan an experiment, add the
/// named effect.
#[test]
fn a_leak_is_diagnosed_shown_by_an_experiment_and_added_as_it_was_fitted() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 10.0);
    let events = browser.work(
        &session,
        &format!("{session}/diagnose"),
        &json!({"logs": [1], "check": []}),
    );
    assert_eq!(events.last().unwrap()["state"], "done");
    let stages: Vec<_> = events
        .iter()
        .filter_map(|event| event["stage"].as_str())
        .collect();
    assert!(stages.contains(&"single effects"), "{stages:?}");

    let view = browser.get(&format!("{session}/diagnosis")).json();
    assert_eq!(view["is_of_plant"], true);
    assert_eq!(view["chosen"], json!({"logs": [1], "check": []}));
    let diagnosis = &view["diagnosis"];
    assert_eq!(diagnosis["verdict"], "found");
    assert_eq!(diagnosis["effects"], json!(["chamber_leak"]));
    // Defect seen: the report marked the model as failed, although the diagnosis explains its error.
    let written = browser.work(&session, &format!("{session}/report"), &json!({}));
    assert_eq!(written.last().unwrap()["state"], "done");
    let report = browser.get(&format!("{session}/report/file")).text();
    assert!(report.contains("explained, above the limit") && !report.contains("✗ fail"));
    let file = browser.get(&format!("{session}/diagnosis/json"));
    assert!(
        file.header("content-disposition")
            .unwrap()
            .contains("diagnosis.json")
    );
    assert!(
        file.text()
            .starts_with("{\n  \"schema\": \"retarder.diagnosis/2\"")
            && file.text().ends_with("}\n")
    );
    assert_eq!(&file.json(), diagnosis);
    let session = a_diagnosis_goes_with_its_project(&browser, session, &view);

    let request = json!({"effects": ["chamber_leak"], "limits": {"duration_s": 15.0, "max_bar": null, "max_duty_pct": 100.0}});
    let events = browser.work(&session, &format!("{session}/next-experiment"), &request);
    assert_eq!(events.last().unwrap()["state"], "done", "{events:?}");
    let next = browser.get(&format!("{session}/next-experiment")).json();
    assert_eq!(next["schema"], "retarder.next-experiment/2");
    let csv = browser
        .get(&format!("{session}/next-experiment/csv"))
        .text();
    assert!(
        csv.starts_with("time_s,duty_fill_pct,duty_vent_pct\n0.00,"),
        "{csv:.80}"
    );

    let change = json!({"log": 1, "change": {"add": {"effect": "chamber_leak"}}});
    let refine = browser
        .post(&format!("{session}/refine/change"), &change)
        .json();
    let candidates = diagnosis["candidates"].as_array().unwrap();
    let named = candidates
        .iter()
        .find(|one| one["effect"] == "chamber_leak")
        .unwrap();
    let added = &refine["effects"][0]["parameters"][0];
    let fitted = &named["parameters"][0];
    assert_eq!(refine["effects"][0]["variant"], named["variant"]);
    assert_eq!(added["value"], fitted["value"]);
    for end in ["value", "low", "high"] {
        assert_eq!(added["fitted"][end], fitted[end]);
    }
    // The parameters that differ between rigs are as fitted with the effect.
    let toml = browser.get(&format!("{session}/refine/plant")).text();
    assert!(
        toml.contains("fitted by retarder diagnose to bench.csv; was "),
        "{toml}"
    );
    the_refit_is_a_step_of_its_own(&refine["steps"]);
    let view = browser.get(&format!("{session}/diagnosis")).json();
    assert_eq!(view["is_of_plant"], false, "the plant is another one now");
    assert_eq!(view["explains_plant"], true, "it has the named effect");
    // The report contains the finding, and the change of the plant.
    browser.work(&session, &format!("{session}/report"), &json!({}));
    let state = browser.get(&format!("{session}/report")).json();
    assert_eq!(
        (&state["has_diagnosis"], &state["steps"]),
        (&json!(true), &json!(3))
    );
    let html = browser.get(&format!("{session}/report/file")).text();
    for part in [
        "Which effect is missing?",
        "id=\"history\"",
        "chamber_leak",
        "bench.csv",
    ] {
        assert!(html.contains(part), "{part} is missing");
    }

    // A size outside of its interval is not the one that explains the error.
    let explains_with = |area: f64| {
        let change = json!({"log": 1, "change": {"set": {"effect": "chamber_leak", "key": "area_m2", "value": area}}});
        browser.post(&format!("{session}/refine/change"), &change);
        let view = browser.get(&format!("{session}/diagnosis")).json();
        browser.post(
            &format!("{session}/refine/change"),
            &json!({"log": 1, "change": "undo"}),
        );
        view["explains_plant"].clone()
    };
    assert_eq!(
        explains_with(3.0 * fitted["value"].as_f64().unwrap()),
        false
    );
}

/// Defect seen: the effect was credited with the refit of the ordinary parameters, and a leak mended a coil current.
fn the_refit_is_a_step_of_its_own(steps: &Value) {
    let rms = |step: usize, signal: &str| {
        let errors = steps[step]["errors"].as_array().unwrap();
        let error = errors.iter().find(|error| error["signal"] == signal);
        error.unwrap()["rms"].as_f64().unwrap()
    };
    assert_eq!(
        [&steps[1]["done"], &steps[2]["done"]],
        [
            "refitted the ordinary parameters together with chamber leak",
            "added chamber leak (orifice)"
        ]
    );
    let share = rms(2, "i_fill") / rms(1, "i_fill");
    assert!((share - 1.0).abs() < 0.02, "{share}: {steps}");
    assert!(rms(2, "p_ch") < 0.3 * rms(0, "p_ch"), "{steps}");
}

/// Closes the session and opens it again, as a reload of the page does, and duplicates its tab; returns the session's
/// path.
fn a_diagnosis_goes_with_its_project(
    browser: &Browser<'_>,
    session: String,
    view: &Value,
) -> String {
    let id = session.rsplit('/').next().unwrap();
    let diagnosis = |session: &str| browser.get(&format!("{session}/diagnosis"));
    browser.post(&format!("{session}/close"), &json!({}));
    assert_eq!(diagnosis(&session).status, 404);
    assert_eq!(browser.session(Some(id)), session);
    assert_eq!(&diagnosis(&session).json(), view);
    // The copy of a duplicated tab also has it, until one of its logs changes.
    let copy = browser.session(Some(id));
    assert_eq!(&diagnosis(&copy).json(), view);
    browser.send("DELETE", &format!("{copy}/logs/1"), "text/plain", b"");
    assert_eq!(diagnosis(&copy).json(), Value::Null);
    // A tab without a requested project begins with the logs, and without findings.
    assert_eq!(diagnosis(&browser.session(None)).json(), Value::Null);
    session
}

#[test]
fn the_library_is_listed_with_equations_bounds_and_units() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let effects = browser.get(&format!("{session}/effects")).json();
    let effects = effects.as_array().unwrap();
    assert_eq!(effects.len(), LIBRARY.len());
    let leak = effects
        .iter()
        .find(|effect| effect["id"] == "chamber_leak")
        .unwrap();
    assert_eq!(leak["title"], "Chamber leak");
    assert!(leak["equation"].as_str().unwrap().contains("orifice"));
    let area = &leak["forms"][0]["parameters"][0];
    assert_eq!(
        (&area["key"], &area["unit"], &area["is_log"]),
        (&json!("area_m2"), &json!("m2"), &json!(true))
    );
}

#[test]
fn what_cannot_be_diagnosed_or_planned_is_refused_with_its_reason() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 2.0);
    let diagnose = format!("{session}/diagnose");
    for (request, status, code) in [
        (json!({"logs": [], "check": [1]}), 400, "E-WEB-VALUE"),
        (json!({"logs": [1], "check": [1]}), 400, "E-WEB-VALUE"),
        (json!({"logs": [7], "check": []}), 404, "E-WEB-NOT-FOUND"),
    ] {
        let refused = browser.post(&diagnose, &request);
        assert_eq!(
            (refused.status, refused.code().as_str()),
            (status, code),
            "{request}"
        );
    }
    let request = json!({"effects": ["chamber_leak"], "limits": {"duration_s": 15.0, "max_bar": null, "max_duty_pct": 100.0}});
    let early = browser.post(&format!("{session}/next-experiment"), &request);
    assert_eq!(
        (early.status, early.code().as_str()),
        (409, "E-WEB-TOO-EARLY")
    );
    // An empty result is an answer; an empty file is refused.
    for path in ["diagnosis", "next-experiment"] {
        let answer = browser.get(&format!("{session}/{path}"));
        assert_eq!(answer.json(), Value::Null, "{path}");
    }
    for path in ["diagnosis/json", "next-experiment/csv"] {
        let answer = browser.get(&format!("{session}/{path}"));
        assert_eq!(answer.status, 409, "{path}");
    }

    // A log that cannot drive the model gives the reason when it is diagnosed.
    browser.upload(
        &session,
        "still.csv",
        b"time_s,p_ch_bar_gauge\n0,1\n1,1\n2,1\n",
    );
    let events = browser.work(&session, &diagnose, &json!({"logs": [2], "check": []}));
    let last = events.last().unwrap();
    assert_eq!(
        (&last["state"], &last["problems"][0]["code"]),
        (&json!("failed"), &json!("E-DIAGNOSE"))
    );
}

/// Defect seen: a comparison, which begins when its page is shown, ended the diagnosis of the same tab.
#[test]
fn a_comparison_or_another_plant_does_not_end_a_diagnosis() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 10.0);
    let begun = browser.post(
        &format!("{session}/diagnose"),
        &json!({"logs": [1], "check": []}),
    );
    let mut events = browser.follow(&session, begun.json()["job"].as_u64().unwrap());
    assert_eq!(browser.compare(&session, 1)["state"], "done");
    let plant = json!({"name": "other.toml", "toml": include_str!("../../../data/plants/practice-first-file.toml")});
    assert_eq!(browser.put(&format!("{session}/plant"), &plant).status, 200);
    let mut rest = String::new();
    events.read_to_string(&mut rest).unwrap();
    assert!(rest.contains(r#"{"state":"done"}"#), "{rest}");
    let view = browser.get(&format!("{session}/diagnosis")).json();
    assert_eq!(view["is_of_plant"], false);
    assert_eq!(view["plant"], "nominal-plant.toml");
}

/// Rule 11: the diagnosis ends if it is stopped. It goes on for a page that is loaded again.
#[test]
fn a_diagnosis_goes_on_for_a_page_that_is_loaded_again_until_it_is_stopped() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 30.0);
    let begun = browser.post(
        &format!("{session}/diagnose"),
        &json!({"logs": [1], "check": []}),
    );
    let job = begun.json()["job"].as_u64().unwrap();
    drop(browser.follow(&session, job));
    let id = session.trim_start_matches("/api/sessions/").to_owned();
    assert_eq!(
        browser.post(&format!("{session}/leave"), &json!({})).status,
        200
    );
    let again = browser
        .post("/api/sessions", &json!({"project": id}))
        .json();
    assert_eq!(again, json!({"session": id, "is_copy": false}));
    drop(browser.follow(&session, job));
    assert_eq!(
        browser
            .send(
                "DELETE",
                &format!("{session}/jobs/{job}"),
                "text/plain",
                b""
            )
            .status,
        200
    );
    // A later request for the job gets its end.
    let events = browser.get(&format!("{session}/jobs/{job}")).text();
    let last: Value = serde_json::from_str(
        events
            .lines()
            .rfind(|line| line.starts_with("data: "))
            .unwrap()
            .trim_start_matches("data: "),
    )
    .unwrap();
    assert_eq!(last["state"], "cancelled", "{events}");
    let found = browser.get(&format!("{session}/diagnosis")).json();
    assert_eq!(found, Value::Null);
}
