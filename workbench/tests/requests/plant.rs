//! Plant of a project.

use serde_json::json;

use crate::bench::Bench;

#[test]
fn the_page_shows_how_well_the_values_of_the_plant_are_known() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let plant = browser.get(&format!("{session}/plant")).text();
    // A value of the thesis with a stated uncertainty is also shown, not only one that differs.
    let toml = plant
        .replace(
            "volume_m3 = 75e-6",
            "volume_m3 = { value = 75e-6, tolerance_pct = 20 }",
        )
        .replace("discharge_fill = 0.95", "discharge_fill = 0.8");
    let put = browser.put(
        &format!("{session}/plant"),
        &json!({"name": "first.toml", "toml": toml}),
    );
    let shown = put.json()["plant"]["changed"].clone();
    let known: Vec<_> = shown
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (one["name"].clone(), one["known"].clone()))
        .collect();
    assert_eq!(
        known,
        [
            (
                json!("flow.discharge_fill"),
                json!("usual tolerance of the part, 0.72 to 0.88; for `refine` 0.48 to 1.12")
            ),
            (
                json!("chamber.volume_m3"),
                json!("within 20 %, 6e-5 to 9e-5 m3")
            ),
        ]
    );
}

#[test]
fn the_sketch_of_the_plant_has_its_effects() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let plant = browser.get(&format!("{session}/plant")).text();
    let with_lag = format!("{plant}\n[effects.sensor_lag]\ntime_constant_s = 0.01\n");
    let put = |toml: &str| {
        let plant = json!({"name": "mine.toml", "toml": toml});
        let shown = browser.put(&format!("{session}/plant"), &plant).json();
        shown["plant"]["sketch"]["text"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    assert!(!put(&plant).contains("+ sensor lag"));
    assert!(put(&with_lag).contains("+ sensor lag"));
}
