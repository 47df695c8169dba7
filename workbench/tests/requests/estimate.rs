//! Page "Estimate": statements about values, the estimation, its experiment, and the edited tables.

use serde_json::{Value, json};

use crate::bench::{Bench, Browser};
use crate::diagnose::with_leaking_log;
use crate::refine::plant;

const VOLUME: &str = "chamber.volume_m3";

fn changed(browser: &Browser<'_>, session: &str, change: &Value) -> crate::bench::Answer {
    let request = json!({"log": 1, "change": change});
    browser.post(&format!("{session}/estimate/change"), &request)
}

fn change(browser: &Browser<'_>, session: &str, change: &Value) -> Value {
    let answer = changed(browser, session, change);
    assert_eq!(answer.status, 200, "{change}: {answer:?}");
    answer.json()
}

fn state(name: &str, known: Value) -> Value {
    json!({"state": {"name": name, "known": known}})
}

/// Returns the row of a parameter.
fn row<'a>(page: &'a Value, name: &str) -> &'a Value {
    let rows = page["parameters"].as_array().unwrap();
    let found = rows.iter().find(|row| row["name"] == name);
    found.unwrap_or_else(|| panic!("{name}: {rows:?}"))
}

#[test]
fn a_statement_is_written_into_the_plant_file_and_shown_in_its_row() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 2.0);
    let opened = browser.get(&format!("{session}/estimate?log=1")).json();
    let volume = row(&opened, VOLUME);
    assert_eq!(
        (&volume["known"], &volume["unit"]),
        (&json!("opened"), &json!("m3"))
    );
    for (known, shown, written) in [
        (json!("fixed"), "fixed", "{ value = 7.5e-5, exact = true }"),
        (
            json!({"tolerance_pct": 30.0}),
            "tolerance",
            "{ value = 7.5e-5, tolerance_pct = 30.0 }",
        ),
        (
            json!({"range": [4e-5, 1.2e-4]}),
            "range",
            "{ value = 7.5e-5, min = 4e-5, max = 0.00012 }",
        ),
        (json!("unknown"), "unknown", "\"unknown\""),
    ] {
        let page = change(&browser, &session, &state(VOLUME, known));
        assert_eq!(row(&page, VOLUME)["known"], shown);
        let toml = plant(&browser, &session);
        assert!(toml.contains(&format!("volume_m3 = {written}")), "{toml}");
    }
    let page = change(
        &browser,
        &session,
        &json!({"value": {"name": "flow.discharge_fill", "value": 0.61}}),
    );
    assert_eq!(row(&page, "flow.discharge_fill")["value"], 0.61);
    let as_opened = change(&browser, &session, &state(VOLUME, json!("opened")));
    assert_eq!(row(&as_opened, VOLUME)["known"], "opened");
    for _ in 0..6 {
        change(&browser, &session, &json!("undo"));
    }
    let undone = browser.get(&format!("{session}/estimate?log=1")).json();
    assert_eq!(
        (&undone["plant"], &undone["at"]),
        (&json!("nominal-plant.toml"), &json!(0))
    );
}

#[test]
fn what_a_plant_file_may_not_state_is_refused_and_changes_nothing() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 2.0);
    let value = |value: f64| json!({"value": {"name": VOLUME, "value": value}});
    for (request, says) in [
        (
            state(VOLUME, json!({"range": [9e-5, 6e-5]})),
            "the lower end comes first",
        ),
        (
            state(VOLUME, json!({"range": [1e-9, 6e-5]})),
            "both lie in 0.0000001 to 1 m3",
        ),
        (
            state(VOLUME, json!({"tolerance_pct": -3.0})),
            "a tolerance of -3 is none",
        ),
        (
            state("chamber.nothing", json!("fixed")),
            "no parameter or table `chamber.nothing`",
        ),
        (value(2.0), "is out of range"),
        (json!("undo"), "there is nothing to undo"),
        (json!("redo"), "there is nothing to redo"),
        (
            json!({"tables": "[valves]\nfill = \"onoff\"\n"}),
            "is not one of normally_closed",
        ),
        (
            json!({"tables": "[chamber]\nvolume_m3 = 1e-4\n"}),
            "`[chamber]` is not edited here",
        ),
    ] {
        let refused = changed(&browser, &session, &request);
        assert!(
            (400..500).contains(&refused.status),
            "{request}: {refused:?}"
        );
        assert!(
            refused.text().contains(says),
            "{request}: {}",
            refused.text()
        );
    }
    let page = browser.get(&format!("{session}/estimate?log=1")).json();
    assert_eq!(page["at"], 0);
    let wrong = changed(
        &browser,
        &session,
        &json!({"tables": "[valves]\nfill = \"onoff\"\n"}),
    );
    assert_eq!(wrong.json()["problems"][0]["line"], 2);
}

/// A value that is fixed does not move; the others do, the error falls while they are estimated, and the fit of an effect starts from
/// the stated file.
#[test]
fn a_fixed_value_stays_and_the_error_of_each_step_is_reported() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 10.0);
    change(
        &browser,
        &session,
        &state("flow.discharge_fill", json!("fixed")),
    );
    let request = json!({"log": 1, "logs": [1], "check": []});
    let events = browser.work(&session, &format!("{session}/estimate/run"), &request);
    assert_eq!(events.last().unwrap()["state"], "done", "{events:?}");
    let errors: Vec<f64> = events
        .iter()
        .filter_map(|event| event["error"]["floors"].as_f64())
        .collect();
    let (first, last) = (errors[0], errors[errors.len() - 1]);
    assert!(last < 0.9 * first, "{errors:?}");

    let page = browser.get(&format!("{session}/estimate?log=1")).json();
    let parameters = page["estimation"]["parameters"].as_array().unwrap();
    assert_eq!(
        page["estimation"]["correlations"].as_array().unwrap().len(),
        parameters.len()
    );
    let is_estimated = |name: &str| parameters.iter().any(|one| one["name"] == name);
    assert!(is_estimated("flow.discharge_vent") && !is_estimated("flow.discharge_fill"));
    assert!(
        plant(&browser, &session).contains("discharge_fill = { value = 0.95, exact = true }"),
        "{}",
        plant(&browser, &session)
    );
    assert_eq!(
        page["steps"][2]["done"],
        "estimated the ordinary parameters from bench.csv"
    );
    an_experiment_determines_its_parameters(&browser, &session);
}

/// Checks that an experiment can be planned for the estimated plant of `session`, and that it is gone with this plant.
fn an_experiment_determines_its_parameters(browser: &Browser<'_>, session: &str) {
    let path = format!("{session}/estimate/experiment");
    assert_eq!(browser.get(&path).json(), Value::Null);
    assert_eq!(browser.get(&format!("{path}/csv")).status, 409);
    let mut request = json!({"log": 1, "logs": [1], "check": [], "limits": {"duration_s": 700.0, "max_bar": null, "max_duty_pct": 100.0}});
    let refused = browser.post(&path, &request).text();
    assert!(
        refused.contains("700 s (above 0, at most 600 s)"),
        "{refused}"
    );
    request["limits"]["duration_s"] = json!(10.0);
    let events = browser.work(session, &path, &request);
    assert_eq!(events.last().unwrap()["state"], "done", "{events:?}");
    let next = browser.get(&path).json();
    assert_eq!(next["schema"], "retarder.determining-experiment/2");
    assert!(next["parameters"].as_array().unwrap().len() > 10, "{next}");
    let csv = browser.get(&format!("{path}/csv")).text();
    assert!(
        csv.starts_with("time_s,duty_fill_pct,duty_vent_pct\n0.00,"),
        "{csv:.80}"
    );
    change(browser, session, &json!("undo"));
    assert_eq!(browser.get(&path).json(), Value::Null);
    let early = browser.post(&path, &request).text();
    assert!(early.contains("estimate them first"), "{early}");
    change(browser, session, &json!("redo"));
    assert_eq!(browser.get(&path).json(), next);
}
