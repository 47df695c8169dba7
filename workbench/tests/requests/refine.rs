//! Page "Refine": effects are added, adjusted, fitted and undone, and the plant of the session follows.

use serde_json::{Value, json};

use crate::bench::{Bench, Browser};
use crate::diagnose::{leaking, with_leaking_log};

pub(crate) fn change(browser: &Browser<'_>, session: &str, change: Value) -> Value {
    let request = json!({"log": 1, "change": change});
    let answer = browser.post(&format!("{session}/refine/change"), &request);
    assert_eq!(answer.status, 200, "{request}: {answer:?}");
    answer.json()
}

/// Returns the rms error of the pressure relative to its noise, from an entry with errors.
fn pressure_in_noise(errors: &Value) -> f64 {
    let errors = errors.as_array().unwrap();
    let pressure = errors
        .iter()
        .find(|error| error["signal"] == "p_ch")
        .unwrap();
    pressure["rms"].as_f64().unwrap() / pressure["noise_floor"].as_f64().unwrap()
}

pub(crate) fn plant(browser: &Browser<'_>, session: &str) -> String {
    browser.get(&format!("{session}/refine/plant")).text()
}

#[test]
fn every_change_is_a_step_that_can_be_undone_and_the_session_has_the_plant() {
    let bench = Bench::start();
    let (session, toml) = {
        let browser = bench.browser();
        let session = with_leaking_log(&browser, 10.0);
        let opened = browser.get(&format!("{session}/refine?log=1")).json();
        assert_eq!(opened["plant"], "nominal-plant.toml");
        let nominal = plant(&browser, &session);
        let before = pressure_in_noise(&opened["steps"][0]["errors"]);

        let added = change(
            &browser,
            &session,
            json!({"add": {"effect": "chamber_leak"}}),
        );
        assert_eq!(added["plant"], "refined.toml");
        assert_eq!(added["at"], 1);
        let after = pressure_in_noise(&added["steps"][1]["errors"]);
        assert!(after < before, "{before} {after}");
        assert!(plant(&browser, &session).contains("[effects.chamber_leak]"));

        change(
            &browser,
            &session,
            json!({"set": {"effect": "chamber_leak", "key": "area_m2", "value": 5e-8}}),
        );
        assert!(
            plant(&browser, &session).contains("area_m2 = 5e-8   # set by hand in the workbench")
        );
        change(&browser, &session, json!("undo"));
        let undone = change(&browser, &session, json!("undo"));
        assert_eq!(
            (&undone["at"], &undone["plant"]),
            (&json!(0), &json!("nominal-plant.toml"))
        );
        assert_eq!(plant(&browser, &session), nominal, "byte for byte");
        let nothing = browser.post(
            &format!("{session}/refine/change"),
            &json!({"log": 1, "change": "undo"}),
        );
        assert_eq!(nothing.code(), "E-WEB-TOO-EARLY");
        change(&browser, &session, json!("redo"));
        change(&browser, &session, json!("redo"));
        assert_eq!(
            browser.get(&format!("{session}/project")).json()["plant"]["effects"],
            json!(["chamber_leak"])
        );
        let toml = plant(&browser, &session);
        (session, toml)
    };

    // The steps are stored over a restart of the server.
    let bench = bench.restart();
    let browser = bench.browser();
    let again = browser.session(Some(session.rsplit('/').next().unwrap()));
    assert_eq!(plant(&browser, &again), toml);
    let undone = change(&browser, &again, json!("undo"));
    assert_eq!(
        (&undone["at"], undone["steps"].as_array().unwrap().len()),
        (&json!(1), 3)
    );

    // Another plant begins another history, and its report contains nothing of this one.
    let steps_of_report = || browser.get(&format!("{again}/report")).json()["steps"].clone();
    assert_eq!(steps_of_report(), 3);
    browser.put(&format!("{again}/plant"), &json!({"name": ""}));
    assert_eq!(steps_of_report(), 0);
    let anew = browser.get(&format!("{again}/refine?log=1")).json();
    assert_eq!(anew["steps"].as_array().unwrap().len(), 1);
}

/// Errors on different logs cannot be compared. Defect seen: a step kept those of the log on which it was made.
#[test]
fn the_step_that_holds_has_the_errors_on_the_log_that_is_seen() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 10.0);
    browser.upload(&session, "check.csv", leaking(4.0).as_bytes());
    let step = |log: u32| {
        let page = browser.get(&format!("{session}/refine?log={log}")).json();
        let step = &page["steps"][0];
        (step["log"].clone(), pressure_in_noise(&step["errors"]))
    };
    let (name, on_bench) = step(1);
    assert_eq!(name, "bench.csv");
    let (name, on_check) = step(2);
    assert_eq!(name, "check.csv");
    assert_ne!(on_bench, on_check);
    assert_eq!(step(1), (json!("bench.csv"), on_bench));
}

/// Goal: a moving slider changes nothing, and shows the result of Compare. Method: the same plant in both ways.
#[test]
fn a_moved_slider_is_simulated_and_nothing_else() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 10.0);
    change(
        &browser,
        &session,
        json!({"add": {"effect": "chamber_leak"}}),
    );
    let before = plant(&browser, &session);
    let moved = browser
        .get(&format!(
            "{session}/refine/simulation?log=1&points=200&from_s=2&to_s=5&effect=chamber_leak&key=area_m2&value=4e-8"
        ))
        .json();
    assert_eq!(plant(&browser, &session), before);
    let error_steps = moved["error_steps"].as_array().unwrap();
    assert_eq!(error_steps.len(), 2);
    assert_eq!(
        (&error_steps[0]["added"], &error_steps[1]["added"]),
        (&Value::Null, &json!("chamber_leak"))
    );
    let pressure = &moved["signals"][0];
    assert_eq!(
        (&pressure["name"], &pressure["unit"]),
        (&json!("p_ch"), &json!("bar gauge"))
    );
    let times = pressure["model"]["t"].as_array().unwrap();
    assert!(
        times.len() <= 450
            && times
                .iter()
                .all(|time| (1.9..=5.1).contains(&time.as_f64().unwrap()))
    );

    change(
        &browser,
        &session,
        json!({"set": {"effect": "chamber_leak", "key": "area_m2", "value": 4e-8}}),
    );
    assert_eq!(browser.compare(&session, 1)["state"], "done");
    let compared = browser.get(&format!("{session}/logs/1/comparison")).json();
    assert_eq!(
        compared["signals"][0]["free_run"]["rms"],
        pressure["error"]["rms"]
    );
}

#[test]
fn a_fit_is_a_step_with_intervals_and_a_falling_error() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 10.0);
    let fit = format!("{session}/refine/fit");
    let request = json!({"log": 1, "logs": [1], "check": []});
    assert_eq!(
        browser.post(&fit, &request).code(),
        "E-WEB-TOO-EARLY",
        "nothing to fit"
    );
    change(
        &browser,
        &session,
        json!({"add": {"effect": "chamber_leak", "form": "orifice"}}),
    );
    change(&browser, &session, json!({"add": {"effect": "sensor_lag"}}));
    change(
        &browser,
        &session,
        json!({"switch": {"effect": "sensor_lag", "is_on": false}}),
    );
    let events = browser.work(&session, &fit, &request);
    assert_eq!(events.last().unwrap()["state"], "done", "{events:?}");

    let fitted = browser.get(&format!("{session}/refine?log=1")).json();
    assert_eq!(
        fitted["steps"][4]["done"],
        "fitted chamber leak and the ordinary parameters to bench.csv"
    );
    let area = &fitted["effects"][0]["parameters"][0];
    let [value, low, high] =
        ["value", "low", "high"].map(|end| area["fitted"][end].as_f64().unwrap());
    assert!(low < value && value < high, "{area}");
    // The file has seven digits of it.
    assert!(
        (area["value"].as_f64().unwrap() / value - 1.0).abs() < 1e-6,
        "{area}"
    );
    assert_eq!(
        (
            &fitted["effects"][1]["effect"],
            &fitted["effects"][1]["is_on"]
        ),
        (&json!("sensor_lag"), &json!(false))
    );
    let error_steps = fitted["fit"]["error_steps"].as_array().unwrap();
    let rms = |step: &Value| step["check_rms"]["p_ch"].as_f64().unwrap();
    assert!(
        rms(&error_steps[2]) < 0.5 * rms(&error_steps[1]),
        "{error_steps:?}"
    );
    let toml = plant(&browser, &session);
    assert!(
        toml.contains("fitted by retarder refine to bench.csv") && !toml.contains("sensor_lag")
    );

    // It can be undone, together with its result.
    let undone = change(&browser, &session, json!("undo"));
    assert_eq!(
        (
            &undone["fit"],
            &undone["effects"][0]["parameters"][0]["fitted"]
        ),
        (&Value::Null, &Value::Null)
    );
}

/// Goal: the change of the ordinary parameters by an estimation is a step of its own, and the effect is credited with
/// the rest only.
#[test]
fn an_estimation_is_a_step_that_effects_are_fitted_on() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 10.0);
    let request = json!({"log": 1, "logs": [1], "check": []});
    let events = browser.work(&session, &format!("{session}/estimate/run"), &request);
    assert_eq!(events.last().unwrap()["state"], "done", "{events:?}");
    let estimated = browser.get(&format!("{session}/refine?log=1")).json();
    assert_eq!(
        estimated["steps"][1]["done"],
        "estimated the ordinary parameters from bench.csv"
    );
    let toml = plant(&browser, &session);
    assert!(toml.contains("chamber"), "{toml}");
    change(
        &browser,
        &session,
        json!({"add": {"effect": "chamber_leak", "form": "orifice"}}),
    );
    let seen = format!("{session}/refine/simulation?log=1&points=50");
    let error_steps = browser.get(&seen).json()["error_steps"].clone();
    let titles: Vec<_> = error_steps.as_array().unwrap().iter().collect();
    let titles: Vec<_> = titles.iter().map(|rung| &rung["title"]).collect();
    assert_eq!(
        titles,
        [
            "plant as opened: nominal-plant.toml",
            "ordinary parameters refitted",
            "+ chamber leak (orifice)"
        ]
    );

    an_ordinary_parameter_is_switched_between_its_values(&browser, &session);

    let events = browser.work(&session, &format!("{session}/refine/fit"), &request);
    assert_eq!(events.last().unwrap()["state"], "done", "{events:?}");
    let mass = |toml: &str| {
        let line = toml.lines().find(|line| line.starts_with("mass_kg"));
        let value = line.unwrap().split_once("value = ").unwrap().1;
        value.split(',').next().unwrap().to_owned()
    };
    let before = format!("was {}", mass(&toml));
    assert!(plant(&browser, &session).contains(&before), "{before}");
    change(
        &browser,
        &session,
        json!({"remove": {"effect": "chamber_leak"}}),
    );
    let estimation =
        || browser.get(&format!("{session}/estimate?log=1")).json()["estimation"].clone();
    assert!(estimation().is_object());
    for _ in 0..4 {
        change(&browser, &session, json!("undo"));
    }
    assert_eq!(estimation(), Value::Null);
}

/// Off, a parameter has its value as opened; on again, the one of the refit. Both switches are undone.
fn an_ordinary_parameter_is_switched_between_its_values(browser: &Browser<'_>, session: &str) {
    const NAME: &str = "flow.discharge_fill";
    let of = |state: &Value| {
        let refitted = state["refitted"].as_array().unwrap().iter();
        let found = refitted.clone().find(|one| one["name"] == NAME);
        found.unwrap().clone()
    };
    let switch =
        |is_refitted: bool| json!({"ordinary": {"name": NAME, "is_refitted": is_refitted}});
    let before = browser.get(&format!("{session}/refine?log=1")).json();
    let plant_before = plant(browser, session);
    let on = of(&before);
    assert!(on["before"].is_f64() && on["before"] != on["after"], "{on}");
    assert_eq!(on["is_refitted"], true);
    let off = of(&change(browser, session, switch(false)));
    assert_eq!(off["is_refitted"], false);
    assert_eq!(
        (&off["before"], &off["after"]),
        (&on["before"], &on["after"])
    );
    assert_ne!(plant(browser, session), plant_before);
    assert_eq!(of(&change(browser, session, switch(true))), on);
    for _ in 0..2 {
        change(browser, session, json!("undo"));
    }
    assert_eq!(plant(browser, session), plant_before);
    let other =
        json!({"log": 1, "change": {"ordinary": {"name": "chamber.nothing", "is_refitted": true}}});
    let refused = browser.post(&format!("{session}/refine/change"), &other);
    assert_eq!(refused.status, 404, "{refused:?}");
}

#[test]
fn what_there_is_not_cannot_be_changed() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 2.0);
    for (request, status) in [
        (
            json!({"log": 1, "change": {"add": {"effect": "nothing"}}}),
            404,
        ),
        (
            json!({"log": 9, "change": {"add": {"effect": "chamber_leak"}}}),
            404,
        ),
        (
            json!({"log": 1, "change": {"remove": {"effect": "chamber_leak"}}}),
            404,
        ),
        (json!({"log": 1, "change": "explode"}), 422),
        (
            json!({"log": 1, "change": {"set": {"effect": "chamber_leak", "key": "area_m2", "value": "much"}}}),
            422,
        ),
    ] {
        let refused = browser.post(&format!("{session}/refine/change"), &request);
        assert_eq!(refused.status, status, "{request}: {refused:?}");
    }
    change(
        &browser,
        &session,
        json!({"add": {"effect": "chamber_leak"}}),
    );
    let beyond = browser.post(
        &format!("{session}/refine/change"),
        &json!({"log": 1, "change": {"set": {"effect": "chamber_leak", "key": "area_m2", "value": 1.0}}}),
    );
    assert_eq!(
        (beyond.status, beyond.code().as_str()),
        (400, "E-WEB-VALUE")
    );
    assert!(
        beyond
            .text()
            .contains("between 0.00000000001 and 0.00001 m2")
            || beyond.text().contains("1e-11"),
        "{}",
        beyond.text()
    );
    assert_eq!(
        browser.get(&format!("{session}/refine?log=1")).json()["at"],
        1
    );
}

/// A definition in the plant file is listed with its law, and added, changed, switched and undone as any other effect.
#[test]
fn an_own_effect_of_the_plant_is_listed_and_changed_as_one_of_the_library() {
    const NOMINAL: &str = include_str!("../../../data/nominal-plant.toml");
    const SEAL: &str = r#"
[own_effects.lifting_seal]
sentence = "The lip of the shaft seal lifts above a pressure."
acts_on = "leak_flow"
expression = "k * max(p - p_lift, 0)"
parameters.k = { typical = 1e-10, range = [1e-12, 1e-8], unit = "kg/s/Pa" }
parameters.p_lift = { typical = 4e5, range = [1.5e5, 9e5], unit = "Pa" }
"#;
    let bench = Bench::start();
    let browser = bench.browser();
    let session = with_leaking_log(&browser, 5.0);
    let own = json!({"name": "own.toml", "toml": format!("{NOMINAL}{SEAL}")});
    assert_eq!(browser.put(&format!("{session}/plant"), &own).status, 200);
    let listed = browser.get(&format!("{session}/effects")).json();
    let listed = listed.as_array().unwrap();
    let seal = listed.iter().find(|one| one["id"] == "own.lifting_seal");
    let seal = seal.unwrap();
    assert_eq!(
        (&seal["title"], &seal["equation"]),
        (&json!("Own lifting seal"), &json!("k * max(p - p_lift, 0)"))
    );
    assert_eq!(seal["forms"][0]["parameters"][0]["is_log"], true);

    let id = "own.lifting_seal";
    change(&browser, &session, json!({"add": {"effect": id}}));
    let written = |text: &str| plant(&browser, &session).contains(text);
    assert!(written("[own_effects.lifting_seal]") && written("[effects.own.lifting_seal]"));
    change(
        &browser,
        &session,
        json!({"set": {"effect": id, "key": "k", "value": 3e-10}}),
    );
    assert!(written("k = 3e-10   # set by hand in the workbench"));
    change(
        &browser,
        &session,
        json!({"switch": {"effect": id, "is_on": false}}),
    );
    assert!(!written("[effects.own.lifting_seal]"));
    change(
        &browser,
        &session,
        json!({"switch": {"effect": id, "is_on": true}}),
    );
    assert!(written("k = 3e-10"));
    change(&browser, &session, json!({"remove": {"effect": id}}));
    assert!(written("[own_effects.lifting_seal]") && !written("[effects.own.lifting_seal]"));
}
