//! Detail charts of a comparison, as numbers.

use serde_json::{Value, json};

use crate::bench::{Bench, Browser};

const LOG: &str = include_str!("../../../data/synthetic/practice-01-id.csv");

/// Returns a session with a compared log, number 1.
pub(crate) fn compared(browser: &Browser<'_>) -> String {
    let session = browser.session(None);
    browser.upload(&session, "practice-01-id.csv", LOG.as_bytes());
    assert_eq!(browser.compare(&session, 1)["state"], "done");
    session
}

fn numbers(list: &Value) -> Vec<f64> {
    let list = list.as_array().unwrap().iter();
    list.map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn a_residual_has_a_distribution_and_a_spectrum_that_agree_with_its_metrics() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = compared(&browser);
    let get = |path: &str| browser.get(&format!("{session}/logs/1/{path}")).json();
    let traces = get("traces?points=400&from_s=5&to_s=45");
    let signals = traces["signals"].as_array().unwrap();
    let residual = &signals.iter().find(|one| one["name"] == "p_ch").unwrap()["residual"];
    let metrics = &residual["metrics"];

    let distribution = get("distribution?signal=p_ch&of=residual&from_s=5&to_s=45");
    let histogram = &distribution["histogram"];
    assert_eq!(distribution["unit"], residual["unit"]);
    assert_eq!(distribution["noise"], residual["noise"]);
    assert_eq!(histogram["samples"], metrics["samples"]);
    assert_eq!(histogram["mean"], metrics["bias"]);
    let area = numbers(&histogram["density"]).iter().sum::<f64>()
        * histogram["bin_width"].as_f64().unwrap();
    assert!((area - 1.0).abs() < 1e-9, "{area}");

    let spectral = get("spectrum?signal=p_ch&of=residual&from_s=5&to_s=45");
    let spectrum = &spectral["spectrum"];
    let [frequency_hz, density] = [&spectrum["frequency_hz"], &spectrum["density"]].map(numbers);
    assert_eq!(frequency_hz.len(), density.len());
    assert!(frequency_hz[0] > 0.0 && frequency_hz.is_sorted() && frequency_hz.len() <= 2048);
    assert!(density.iter().all(|density| *density >= 0.0));
    let noise = distribution["noise"].as_f64().unwrap();
    let nyquist_hz = frequency_hz[frequency_hz.len() - 1];
    let level = spectral["noise_level"].as_f64().unwrap();
    assert!((level * nyquist_hz / (noise * noise) - 1.0).abs() < 1e-9);

    // A command also has a histogram and a spectrum, but neither noise nor model. Without values there are no
    // statistics.
    let command = get("distribution?signal=duty_fill&of=measured");
    assert_eq!(
        (&command["unit"], &command["noise"]),
        (&json!("%"), &Value::Null)
    );
    assert_eq!(
        get("distribution?signal=p_ch&of=modelled&from_s=1e6&to_s=2e6")["histogram"],
        Value::Null
    );
    assert_eq!(
        get("spectrum?signal=p_ch&of=measured&from_s=1&to_s=1.1")["spectrum"],
        Value::Null
    );
}

#[test]
fn a_look_at_what_is_not_there_is_refused() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = compared(&browser);
    for path in [
        "distribution?signal=nothing&of=measured",
        "distribution?signal=duty_fill&of=residual",
        "distribution?signal=p_ch&of=everything",
        "distribution?signal=p_ch",
        "spectrum?signal=p_ch&of=residual&from_s=9&to_s=3",
        "spectrum?signal=p_ch&of=residual&from_s=inf",
        "spectrum?of=residual",
    ] {
        let answer = browser.get(&format!("{session}/logs/1/{path}"));
        assert!(matches!(answer.status, 400 | 404), "{path}: {answer:?}");
    }
    let answer = browser.get(&format!(
        "{session}/logs/2/spectrum?signal=p_ch&of=residual"
    ));
    assert_eq!(answer.status, 409, "{answer:?}");
}

/// Returns the time series of a signal in a view.
fn signal(browser: &Browser<'_>, session: &str, view: &str, name: &str) -> Value {
    let traces = browser
        .get(&format!("{session}/logs/1/traces?points=800&{view}"))
        .json();
    let signals = traces["signals"].as_array().unwrap();
    signals
        .iter()
        .find(|one| one["name"] == name)
        .unwrap()
        .clone()
}

/// A tolerance that is absolute, relative and in time, in the page's own notation.
#[test]
fn a_tolerance_judges_the_samples_of_the_view_and_leaves_the_comparison() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = compared(&browser);
    assert_eq!(
        signal(&browser, &session, "", "p_ch")["residual"]["band"],
        Value::Null
    );
    let set = |band: Value| {
        let strictness =
            json!({"allowed_noise_multiples": 1.5, "tolerances": {}, "bands": {"p_ch": band}});
        browser.put(&format!("{session}/strictness"), &strictness)
    };
    assert_eq!(set(json!({"absolute": 100.0})).status, 200);
    assert_eq!(browser.compare(&session, 1)["state"], "done");

    let wide = signal(&browser, &session, "", "p_ch")["residual"].clone();
    assert_eq!(wide["band"]["holds"], true);
    assert_eq!(wide["band"]["samples"], wide["metrics"]["samples"]);
    let tight = json!({"absolute": 1e-6, "beyond_max": 0.5});
    assert_eq!(set(tight).status, 200);
    // The bands judge existing results: the comparison is not computed again.
    let comparison = browser.get(&format!("{session}/logs/1/comparison"));
    assert_eq!(comparison.status, 200, "{comparison:?}");
    let view = "from_s=10&to_s=20";
    let tight = signal(&browser, &session, view, "p_ch")["residual"]["band"].clone();
    assert_eq!(tight["holds"], false);
    assert!(tight["beyond"].as_f64().unwrap() > 0.9, "{tight}");
    assert_eq!(
        set(json!({"absolute": 1e-6, "beyond_max": 1.0})).status,
        200
    );
    let allowed = signal(&browser, &session, view, "p_ch")["residual"]["band"].clone();
    assert_eq!(allowed["holds"], true);

    for wrong in [
        json!({}),
        json!({"absolute": -1.0}),
        json!({"absolute": 1.0, "relative": 1.5}),
        json!({"relative": 0.1, "time_s": 1e9}),
        json!({"absolute": 1.0, "beyond_max": 2.0}),
        json!({"absolute": null}),
        json!({"absolute": 1.0, "more": 1.0}),
    ] {
        let answer = set(wrong.clone());
        assert!(matches!(answer.status, 400 | 422), "{wrong}: {answer:?}");
    }
    let kept = browser.get(&format!("{session}/project")).json();
    assert_eq!(kept["strictness"]["bands"]["p_ch"]["beyond_max"], 1.0);
}

#[test]
fn the_states_of_the_valves_cover_the_view_when_they_are_asked_for() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = compared(&browser);
    let get = |more: &str| {
        browser
            .get(&format!("{session}/logs/1/traces?points=400{more}"))
            .json()["states"]
            .clone()
    };
    assert_eq!(get(""), json!([]));
    let states = get("&states=true");
    let states = states.as_array().unwrap();
    for state in ["filling", "venting", "shut"] {
        assert!(states.iter().any(|one| one["state"] == state), "{state}");
    }
    let time = |one: &Value, key: &str| one[key].as_f64().unwrap();
    for pair in states.windows(2) {
        assert_eq!(time(&pair[0], "to_s"), time(&pair[1], "from_s"));
        assert_ne!(pair[0]["state"], pair[1]["state"]);
    }
}

/// The statistics cover the visible range; the drawn range is larger.
#[test]
fn what_is_drawn_beside_a_view_does_not_count() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = compared(&browser);
    let view = "from_s=10&to_s=20";
    let narrow = signal(&browser, &session, view, "p_ch");
    let wide = signal(&browser, &session, &format!("{view}&beside=0.5"), "p_ch");
    assert_eq!(narrow["residual"]["metrics"], wide["residual"]["metrics"]);
    let begin = |signal: &Value| signal["measured"]["t"][0].as_f64().unwrap();
    assert!(begin(&narrow) > 9.9 && begin(&wide) < 5.1);
    for beside in ["-1", "1e9", "nan"] {
        let path = format!("{session}/logs/1/traces?points=100&{view}&beside={beside}");
        assert_eq!(browser.get(&path).status, 400, "{beside}");
    }
}

/// The same log a second later: the difference is zero only after it is shifted back.
#[test]
fn a_log_minus_another_one_is_what_is_left_on_their_overlap() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let log = |delay: u32| {
        let row = |index: u32| {
            let duty = if index % 20 < 10 { 40 } else { 0 };
            let pressure_bar = f64::from(index * index) * 1e-3;
            format!("{},{duty},0,{pressure_bar:.3}\n", index + delay)
        };
        let rows: String = (0..100).map(row).collect();
        format!("time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge\n{rows}")
    };
    browser.upload(&session, "now.csv", log(0).as_bytes());
    browser.upload(&session, "late.csv", log(5).as_bytes());
    let get = |more: &str| {
        let path = format!("{session}/logs/1/difference?other=2&points=400{more}");
        browser.get(&path).json()["signals"].clone()
    };
    // Both duty cycles and the pressure, in the order of the columns.
    let apart = get("");
    assert_eq!(apart[0]["between"], "hold");
    assert_eq!(
        (&apart[2]["between"], &apart[2]["unit"]),
        (&json!("linear"), &json!("bar"))
    );
    assert_eq!(apart[2]["metrics"]["samples"], 95);
    assert!(apart[2]["metrics"]["rms"].as_f64().unwrap() > 0.1);

    let shift = |offset_s: f64| {
        let body = json!({ "offset_s": offset_s });
        browser.put(&format!("{session}/logs/2/offset"), &body);
    };
    shift(-5.0);
    for difference in get("").as_array().unwrap() {
        assert_eq!(difference["metrics"]["samples"], 100);
        assert_eq!(difference["metrics"]["rms"], 0.0, "{difference}");
    }
    // Half an interval late.
    shift(-4.5);
    let linear = get("&from_s=10&to_s=20");
    let worst = |difference: &Value| difference["metrics"]["highest"].as_f64().unwrap();
    // At i, in mbar: i² - ((i - 1)² + i²)/2 = i - 1/2, and held: i² - (i - 1)² = 2i - 1.
    assert!((worst(&linear[2]) - 0.0195).abs() < 1e-9, "{linear}");
    let held = get("&from_s=10&to_s=20&between=hold");
    assert_eq!(held[2]["between"], "hold");
    assert!((worst(&held[2]) - 0.039).abs() < 1e-9, "{held}");
    // The time series continues beside the view, and the numbers do not include that part.
    let beside = get("&from_s=10&to_s=20&beside=0.5");
    assert_eq!(beside[2]["metrics"], linear[2]["metrics"]);
    let ends = |difference: &Value| {
        let times = difference["trace"]["t"].as_array().unwrap();
        [times[0].clone(), times[times.len() - 1].clone()]
    };
    assert_eq!(ends(&linear[2]), [10.0, 20.0]);
    assert_eq!(ends(&beside[2]), [5.0, 25.0]);

    shift(-1000.0);
    assert_eq!(get("")[1]["metrics"], Value::Null);
    for path in [
        "difference?other=9&points=9",
        "difference?other=2&points=9&between=cubic",
        "difference?other=2",
        "difference?other=2&points=9&from_s=3&to_s=1",
        "difference?other=2&points=9&beside=2",
    ] {
        let answer = browser.get(&format!("{session}/logs/1/{path}"));
        assert!(matches!(answer.status, 400 | 404), "{path}: {answer:?}");
    }
}
