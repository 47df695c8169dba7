//! Closed loop: settings, results and refusals.

use serde_json::{Value, json};

use crate::bench::{Bench, Browser};

const NOMINAL: &str = include_str!("../../../data/nominal-plant.toml");
const LEAK: &str = "\n[effects.chamber_leak]\nvariant = \"orifice\"\narea_m2 = 2e-8\n";

/// Returns a step up and a step down, two seconds.
fn short_profile() -> Value {
    json!({
        "name": "short", "start_pressure_bar": 0.0, "start_bar": 0.0, "end_s": 2.0,
        "changes": [{"time_s": 0.2, "to_bar": 3.0, "within_s": 0.0}, {"time_s": 1.2, "to_bar": 2.0, "within_s": 0.0}],
    })
}

fn body(profile: &Value, rigs: u32) -> Value {
    json!({"scenario": "figure-6.5", "profile": profile, "seed": 1, "rigs": rigs})
}

/// Begins a job and returns its last event.
fn work(browser: &Browser<'_>, session: &str, what: &str) -> Value {
    let mut events = browser.work(session, &format!("{session}/{what}"), &json!({}));
    events.pop().unwrap()
}

#[test]
fn the_loop_is_that_of_the_command_and_judged_alike() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let shown = browser.get(&format!("{session}/control")).json();
    assert_eq!(shown["scenario"], "figure-6.5");
    assert_eq!(shown["plants"].as_array().unwrap().len(), 1);
    assert_eq!(
        browser.get(&format!("{session}/control/result")).code(),
        "E-WEB-TOO-EARLY"
    );
    assert_eq!(work(&browser, &session, "control/run")["state"], "done");
    let result = browser.get(&format!("{session}/control/result")).json();
    let scenario = hil_harness::Scenario::built_in("figure-6.5")
        .unwrap()
        .on(plant_sim::PlantParameters::nominal());
    let verdict = hil_harness::run_in_process(&scenario)
        .unwrap()
        .verdict(&hil_harness::Requirement::THESIS)
        .unwrap();
    assert_eq!(
        result["runs"][0]["verdict"],
        serde_json::to_value(&verdict).unwrap()
    );
    assert_eq!(result["is_current"], true);
    let traces = browser
        .get(&format!(
            "{session}/control/traces?points=300&from_s=1&to_s=2"
        ))
        .json();
    let names: Vec<&str> = traces["signals"]
        .as_array()
        .unwrap()
        .iter()
        .map(|signal| signal["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "p_ref",
            "p_ch",
            "duty_fill",
            "duty_vent",
            "i_fill",
            "i_vent",
            "x_fill",
            "x_vent"
        ]
    );
    let times = traces["signals"][1]["runs"][0]["t"].as_array().unwrap();
    assert!((100..=103).contains(&times.len()), "{}", times.len());
    let csv = browser.get(&format!("{session}/control/csv?run=0")).text();
    assert!(
        csv.starts_with("# ") || csv.starts_with("time_s"),
        "{:.80}",
        csv
    );
    assert_eq!(
        browser.get(&format!("{session}/control/csv?run=1")).status,
        404
    );
}

/// A plant with effects runs beside itself without them; both runs are in one result.
#[test]
fn a_refined_plant_is_run_beside_the_plain_one() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let plant = json!({"name": "leaky.toml", "toml": format!("{NOMINAL}{LEAK}")});
    assert_eq!(browser.put(&format!("{session}/plant"), &plant).status, 200);
    browser.put(&format!("{session}/control"), &body(&short_profile(), 4));
    assert_eq!(work(&browser, &session, "control/run")["state"], "done");
    let result = browser.get(&format!("{session}/control/result")).json();
    let roles: Vec<&str> = result["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["plant"]["role"].as_str().unwrap())
        .collect();
    assert_eq!(roles, ["plain", "refined"]);
    assert_eq!(
        result["runs"][1]["plant"]["effects"],
        json!(["chamber_leak"])
    );
    let traces = browser
        .get(&format!("{session}/control/traces?points=1000"))
        .json();
    let [plain, refined] = [0, 1].map(|run| &traces["signals"][1]["runs"][run]["y"]);
    assert_ne!(plain, refined, "the leak is seen");
    // With another plant, the old run is marked as that of an earlier one.
    browser.put(
        &format!("{session}/plant"),
        &json!({"name": "", "toml": null}),
    );
    let result = browser.get(&format!("{session}/control/result")).json();
    assert_eq!(result["is_current"], false);
}

/// The settings are those of a controller file, and refusals have the text and the lines of that file's reader.
#[test]
fn settings_of_the_controller_are_checked_as_in_its_file() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let put = |settings: &Value| browser.put(&format!("{session}/control/controller"), settings);
    let set = |path: &str, value: Option<&str>| {
        put(&json!({"from": "values", "values": [[path, value]]}))
    };
    let gain = set("pid.gain_pct_per_bar", Some("30"));
    assert_eq!(gain.status, 200, "{gain:?}");
    let controller = &gain.json()["controller"];
    assert_eq!(controller["name"], "recommended controller, changed");
    let toml = browser.get(&format!("{session}/control/controller")).text();
    assert!(
        toml.contains("gain_pct_per_bar = 30   # typed in the workbench"),
        "{toml}"
    );
    hil_harness::controller_file::read(&toml, "C").unwrap();

    for (path, value, expected) in [
        ("pid.gain_pct_per_bar", Some("4000"), "1000 %/bar"),
        ("pid.gain_pct_per_bar", None, "is missing in [pid]"),
        (
            "pid.gain_pct_per_bar",
            Some("1\n[x]"),
            "pid.gain_pct_per_bar",
        ),
        (
            "pid.anti_windup",
            Some("back_calculation"),
            "`tracking_time_ms` is missing",
        ),
        ("pid.anti_windup", Some("on"), "\"off\""),
    ] {
        let refused = set(path, value);
        assert_eq!(
            (refused.status, refused.code()),
            (422, "E-CONTROLLER".to_owned())
        );
        assert!(
            refused.text().replace("\\\"", "\"").contains(expected),
            "{refused:?}"
        );
    }
    assert_eq!(set("pid.nothing", Some("1")).status, 404);
    let file = format!(
        "{}\nunknown = 1\n",
        hil_harness::controller_file::THESIS_TOML
    );
    let lines = file.lines().count();
    let refused = put(&json!({"from": "file", "name": "mine.toml", "toml": file}));
    assert_eq!(refused.json()["problems"][0]["line"], json!(lines));
    // The refused request changed nothing.
    assert_eq!(
        browser.get(&format!("{session}/control/controller")).text(),
        toml
    );
    assert_eq!(
        put(&json!({"from": "thesis"})).json()["controller"]["name"],
        "thesis controller"
    );
}

#[test]
fn a_profile_is_checked_and_kept_over_a_restart() {
    let bench = Bench::start();
    let session = {
        let browser = bench.browser();
        let session = browser.session(None);
        let put = |change: &dyn Fn(&mut Value)| {
            let mut profile = short_profile();
            change(&mut profile);
            browser.put(&format!("{session}/control"), &body(&profile, 4))
        };
        for (change, expected) in [
            (
                &(|profile: &mut Value| profile["changes"][1]["time_s"] = json!(0.1))
                    as &dyn Fn(&mut Value),
                "order of time",
            ),
            (
                &|profile| profile["changes"][1]["to_bar"] = json!(16),
                "out of range",
            ),
            (
                &|profile| profile["end_s"] = json!(1e9),
                "(0 to 600 s on this page)",
            ),
            (
                &|profile| profile["changes"][0]["time_s"] = json!(-1),
                "(0 to 600 s on this page)",
            ),
            (
                &|profile| profile["start_pressure_bar"] = json!(9),
                "supply pressure",
            ),
            (
                &|profile| {
                    profile["changes"] =
                        json!(vec![json!({"time_s": 0, "to_bar": 1, "within_s": 0}); 1001])
                },
                "1001 changes (at most 1000 on this page)",
            ),
        ] {
            let refused = put(change);
            assert!(matches!(refused.status, 400 | 422), "{refused:?}");
            assert!(refused.text().contains(expected), "{refused:?}");
        }
        for rigs in [0, 1001] {
            let refused = browser.put(&format!("{session}/control"), &body(&short_profile(), rigs));
            assert_eq!(
                (refused.status, refused.code()),
                (400, "E-WEB-VALUE".to_owned())
            );
        }
        let nothing = json!({"scenario": "nothing", "profile": null, "seed": 1, "rigs": 4});
        assert_eq!(
            browser.put(&format!("{session}/control"), &nothing).status,
            404
        );
        let csv =
            json!({"name": "../up.csv", "csv": "time_s,p_ref_bar_gauge\n0,0\n1,4\n3,2\n4,2\n"});
        let taken = browser.put(&format!("{session}/control/reference"), &csv);
        assert_eq!(taken.status, 200, "{taken:?}");
        assert_eq!(taken.json()["profile"]["name"], "up.csv");
        assert_eq!(
            taken.json()["profile"]["changes"][0],
            json!({"time_s": 1.0, "to_bar": 4.0, "within_s": 0.0})
        );
        let wrong = json!({"name": "x.csv", "csv": "time_s,p_ref_bar_abs\n0,1\n1,2\n"});
        assert_eq!(
            browser
                .put(&format!("{session}/control/reference"), &wrong)
                .code(),
            "E-REFERENCE"
        );
        assert_eq!(put(&|_| ()).status, 200);
        session
    };
    let bench = bench.restart();
    let browser = bench.browser();
    let again = browser.session(session.rsplit('/').next());
    let shown = browser.get(&format!("{again}/control")).json();
    assert_eq!(
        (&shown["profile"], &shown["rigs"]),
        (&short_profile(), &json!(4))
    );
}

/// The rigs of a batch are those of `retarder control --rigs --supply-voltage 24 --coil-temperature 20`, with the settling
/// times of all steps.
#[test]
fn a_batch_is_that_of_the_command_with_its_settling_times() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    browser.put(&format!("{session}/control"), &body(&short_profile(), 5));
    assert_eq!(
        browser.get(&format!("{session}/control/batch")).code(),
        "E-WEB-TOO-EARLY"
    );
    assert_eq!(work(&browser, &session, "control/batch")["state"], "done");
    let batch = browser.get(&format!("{session}/control/batch")).json();
    let rigs = &batch["plants"][0];
    assert_eq!(
        (&rigs["rigs"], &batch["is_current"]),
        (&json!(5), &json!(true))
    );
    assert_eq!(
        rigs["steps"]["count"],
        json!(10),
        "two steps on each rig: {rigs}"
    );
    assert_eq!(rigs["slowest"]["count"], json!(5));
    let points = rigs["slowest"]["points"].as_array().unwrap();
    assert!(!points.is_empty() && points.iter().all(|point| point[1].as_f64().unwrap() <= 1.0));
    assert_eq!(batch["requirement"]["t_req_samples"], 50);
    browser.put(&format!("{session}/control"), &body(&short_profile(), 6));
    assert_eq!(
        browser.get(&format!("{session}/control/batch")).json()["is_current"],
        false
    );
}

/// Rule 11: a batch ends with the page that follows it, long before its last rig.
#[test]
fn a_batch_that_nobody_watches_is_stopped() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let many = json!({"scenario": "operating-range", "profile": null, "seed": 1, "rigs": 1000});
    browser.put(&format!("{session}/control"), &many);
    let begun = browser.post(&format!("{session}/control/batch"), &json!({}));
    let job = begun.json()["job"].as_u64().unwrap();
    assert_eq!(
        browser.post(&format!("{session}/close"), &json!({})).status,
        200
    );
    assert_eq!(browser.get(&format!("{session}/jobs/{job}")).status, 404);
    // The next one does not wait for it: both places for work are free again.
    for _ in 0..3 {
        let session = browser.session(None);
        browser.put(&format!("{session}/control"), &body(&short_profile(), 1));
        assert_eq!(work(&browser, &session, "control/run")["state"], "done");
    }
}

#[test]
fn a_plant_without_both_valves_and_the_chamber_is_refused_with_the_reason() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    browser.post(
        &format!("{session}/examples/inrush-blocked"),
        &json!({"keep": false}),
    );
    let shown = browser.get(&format!("{session}/control")).json();
    assert!(
        shown["problems"][0]["message"]
            .as_str()
            .unwrap()
            .contains("needs both valves"),
        "{shown}"
    );
    assert_eq!(
        browser
            .post(&format!("{session}/control/run"), &json!({}))
            .code(),
        "E-WEB-VALUE"
    );
}
