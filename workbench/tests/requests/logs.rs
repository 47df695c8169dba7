//! Logs as text, wrong logs, and the parts of a comparison that the page can request.

use serde_json::{Value, json};

use crate::bench::{Bench, Browser};

/// Names of signals and files from users and attackers.
const HOSTILE: [&str; 12] = [
    "\"><img src=x onerror=alert(1)>",
    "</script><script>alert(1)</script>",
    "<svg/onload=alert(1)>",
    "javascript:alert(1)",
    "{{7*7}}${7*7}",
    "'; DROP TABLE logs; --",
    "=cmd|' /C calc'!A0",
    "%3Cscript%3E",
    "&lt;b&gt;",
    "<!--",
    "\\u003cscript\\u003e",
    "__proto__",
];

fn escaped(text: &str) -> String {
    text.bytes().map(|byte| format!("%{byte:02x}")).collect()
}

fn project(browser: &Browser<'_>, session: &str) -> Value {
    browser.get(&format!("{session}/project")).json()
}

/// Rule 8: a name is returned unchanged, as JSON; only the one page is markup.
#[test]
fn names_come_back_as_text_and_never_as_markup() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    for name in HOSTILE {
        let quoted = name.replace('"', "\"\"");
        let log = format!(
            "time_s,\"{quoted} [bar gauge]\",duty_fill_pct,duty_vent_pct\n0,1,0,0\n1,2,0,0\n"
        );
        let added = browser.upload(&session, &escaped(name), log.as_bytes());
        assert_eq!(added.status, 200, "{added:?}");
        assert_eq!(added.header("content-type"), Some("application/json"));
        let number = &added.json()["log"];
        let logs = added.json()["project"]["logs"].clone();
        let log = logs
            .as_array()
            .unwrap()
            .iter()
            .find(|log| log["number"] == *number)
            .unwrap();
        let shown = name.rsplit(['/', '\\']).next().unwrap();
        assert_eq!(log["name"], shown);
        if log["problem"] == Value::Null {
            assert_eq!(log["summary"]["signals"][0]["name"], name);
        }
        for path in [
            "preview",
            "traces?points=100",
            "values?time_s=0",
            "comparison",
            "csv",
        ] {
            let answer = browser.get(&format!("{session}/logs/{number}/{path}"));
            let kind = answer.header("content-type").unwrap();
            assert!(
                kind.starts_with("application/json") || kind.starts_with("text/csv"),
                "{path}: {kind}"
            );
        }
        // A spreadsheet would run a name that begins like a formula.
        let csv = browser.get(&format!("{session}/logs/{number}/csv")).text();
        assert!(
            !csv.lines()
                .flat_map(|line| line.split(','))
                .any(|cell| cell.starts_with(['=', '@'])),
            "{csv}"
        );
        browser.send(
            "DELETE",
            &format!("{session}/logs/{number}"),
            "text/plain",
            b"",
        );
    }
}

#[test]
fn a_wrong_log_stays_with_its_line_and_is_read_once_its_columns_are_explained() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let wrong = b"time_s,p_ch_bar_gauge\n0.00,1.5\n0.00,1.6\n";
    let added = browser.upload(&session, "wrong.csv", wrong).json();
    let problem = &added["project"]["logs"][0]["problem"];
    assert_eq!(
        (&problem["code"], &problem["line"]),
        (&json!("E-CSV-TIME-ORDER"), &json!(3))
    );

    let wild = b"Zeit;Druck;Rest\n0,0;1,5;x\n0,5;1,6;y\n";
    let added = browser.upload(&session, "wild.csv", wild).json();
    assert_ne!(added["project"]["logs"][1]["problem"], Value::Null);
    let preview = browser.get(&format!("{session}/logs/2/preview")).json();
    assert_eq!(
        preview["head"]["lines"][0]["cells"],
        json!(["Zeit", "Druck", "Rest"])
    );
    let form = json!({
        "columns": [
            {"column": 1, "role": "time", "unit": "s"},
            {"column": 2, "role": "signal", "name": "p_ch", "unit": "bar_gauge"},
            {"column": 3, "role": "ignore"},
        ],
        "delimiter": "semicolon",
    });
    let mapped = browser
        .put(&format!("{session}/logs/2/mapping"), &form)
        .json();
    assert_eq!(mapped["logs"][1]["problem"], Value::Null, "{mapped}");
    assert_eq!(
        mapped["logs"][1]["summary"]["signals"][0]["reference"],
        "gauge"
    );
    // The next log of this logger needs no second mapping.
    let again = browser
        .upload(
            &session,
            "next.csv",
            b"Zeit;Druck;Rest\n0,0;2,5;x\n0,5;2,6;y\n",
        )
        .json();
    assert_eq!(
        again["project"]["logs"][2]["problem"],
        Value::Null,
        "{again}"
    );
    assert_eq!(again["project"]["logs"][2]["is_mapped"], true);

    let refused = browser.put(
        &format!("{session}/logs/2/mapping"),
        &json!({"toml": "schema = 1\n[time]\ncolumn = 0\nunit = \"s\"\n"}),
    );
    assert_eq!(
        (
            refused.status,
            refused.json()["problems"][0]["line"].clone()
        ),
        (422, json!(3))
    );
}

#[test]
fn a_wrong_plant_is_refused_with_every_line_and_the_old_one_stays() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let before = browser.get(&format!("{session}/plant")).text();
    let toml = before
        .replace("volume_m3", "volume_litre")
        .replace("[coil]", "[coils]");
    let refused = browser.put(
        &format!("{session}/plant"),
        &json!({"name": "wrong.toml", "toml": toml}),
    );
    assert_eq!(refused.status, 422);
    let problems = refused.json()["problems"].clone();
    assert!(problems.as_array().unwrap().len() >= 2, "{problems}");
    assert!(problems[0]["line"].is_u64(), "{problems}");
    assert_eq!(browser.get(&format!("{session}/plant")).text(), before);
}

/// The log has channels with the names that the export gives to model and residual.
#[test]
fn an_export_keeps_channels_that_are_called_like_its_own() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let row = |row: u32| {
        let time_s = f64::from(row) * 0.01;
        format!("{time_s},0,0,{},7,8,9\n", 0.5 - 0.1 * time_s)
    };
    let rows: String = (0..500).map(row).collect();
    let log = format!(
        "time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge,p_ch_model_V,p_ch_model_2_V,p_ch_residual_V\n{rows}"
    );
    browser.upload(&session, "own.csv", log.as_bytes());
    assert_eq!(browser.compare(&session, 1)["state"], "done");
    let exported = browser.get(&format!("{session}/logs/1/csv"));
    assert_eq!(exported.status, 200, "{exported:?}");
    let text = exported.text();
    let read = recording::csv::read("own.csv", text.as_bytes(), &Default::default()).unwrap();
    let first = |name: &str| read.signal(name).unwrap().get(0).unwrap();
    let own = ["p_ch_model", "p_ch_model_2", "p_ch_residual"].map(first);
    assert_eq!(own, [7.0, 8.0, 9.0]);
    let difference = first("p_ch") - first("p_ch_model_3");
    assert!((difference - first("p_ch_residual_2")).abs() < 1e-12);
    assert!(
        text.contains("# p_ch_model_3: model of p_ch; the log has a channel p_ch_model\n"),
        "{text:.400}"
    );
    let mf4 = browser.get(&format!("{session}/logs/1/mf4"));
    assert_eq!(mf4.status, 200, "{mf4:?}");
}

#[test]
fn the_start_of_a_log_is_reported_and_exported() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let started = include_bytes!("../../../recording/tests/fixtures/mf4/started.mf4");
    let added = browser.upload(&session, "started.mf4", started).json();
    let start = "2024-05-03 16:12:07 UTC+02:00";
    assert_eq!(added["project"]["logs"][0]["summary"]["start"], start);
    let csv = browser.get(&format!("{session}/logs/1/csv")).text();
    assert!(csv.contains(&format!("# recorded: {start}\n")), "{csv}");
    let mf4 = browser.get(&format!("{session}/logs/1/mf4")).body;
    let again = browser.upload(&session, "again.mf4", &mf4).json();
    assert_eq!(again["project"]["logs"][1]["summary"]["start"], start);
}

#[test]
fn a_comparison_is_that_of_the_command_and_can_be_looked_at_from_all_sides() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let opened = browser.post(
        &format!("{session}/examples/practice-01"),
        &json!({"keep": false}),
    );
    assert_eq!(opened.json()["logs"][0]["name"], "practice-01-id.csv");
    for path in [
        "comparison",
        "scatter?signal=p_ch&over=p_ch",
        "fold?signal=i_fill",
    ] {
        let early = browser.get(&format!("{session}/logs/1/{path}"));
        assert_eq!(
            (early.status, early.code()),
            (409, "E-WEB-TOO-EARLY".to_owned()),
            "{path}"
        );
    }
    assert_eq!(browser.compare(&session, 1)["state"], "done");
    let comparison = browser.get(&format!("{session}/logs/1/comparison")).json();
    assert_eq!(comparison["schema"], "retarder.comparison/2");
    assert_eq!(comparison["verdict"]["holds"], false);

    let traces = browser
        .get(&format!(
            "{session}/logs/1/traces?points=500&from_s=10&to_s=20&select=p_ch/valve_state/filling"
        ))
        .json();
    let pressure = traces["signals"]
        .as_array()
        .unwrap()
        .iter()
        .find(|one| one["name"] == "p_ch")
        .unwrap();
    for trace in [
        &pressure["measured"],
        &pressure["model"],
        &pressure["residual"]["trace"],
    ] {
        let times: Vec<f64> = trace["t"]
            .as_array()
            .unwrap()
            .iter()
            .filter_map(Value::as_f64)
            .collect();
        assert!((100..=600).contains(&times.len()), "{}", times.len());
        assert!(times[0] >= 9.99 - 1e-9 && times[times.len() - 1] <= 20.01 + 1e-9);
    }
    assert_eq!(pressure["residual"]["metrics"]["samples"], 1001);
    assert!(
        traces["selection"]["samples"].as_u64().unwrap() > 100,
        "{}",
        traces["selection"]
    );

    let values = browser
        .get(&format!("{session}/logs/1/values?time_s=20.004"))
        .json();
    let pressure = values["signals"]
        .as_array()
        .unwrap()
        .iter()
        .find(|one| one["name"] == "p_ch")
        .unwrap();
    let of = |key: &str| pressure[key].as_f64().unwrap();
    assert_eq!(of("time_s"), 20.0);
    assert!((of("measured") - of("model") - of("residual")).abs() < 1e-9);

    let cell = &comparison["signals"][0]["error_map"];
    let (row, column) = (
        &cell["cells"][3]["duty_band"],
        &cell["cells"][3]["pressure_band"],
    );
    let label = |list: &str, at: &Value| {
        cell[list][at.as_u64().unwrap() as usize]
            .as_str()
            .unwrap()
            .to_owned()
    };
    let select = format!(
        "p_ch/error_map/{}, {}",
        label("duty_bands", row),
        label("pressure_bands", column)
    );
    let marked = browser
        .get(&format!(
            "{session}/logs/1/scatter?signal=p_ch&over=i_fill_model&select={}",
            escaped(&select)
        ))
        .json();
    assert!(!marked["selected"]["x"].as_array().unwrap().is_empty());
    assert!(!marked["points"]["x"].as_array().unwrap().is_empty());
    let fold = browser
        .get(&format!("{session}/logs/1/fold?signal=p_ch&period_ms=1000"))
        .json();
    assert_eq!(fold["samples"], 6000);

    let csv = browser
        .get(&format!("{session}/logs/1/csv?from_s=1&to_s=2"))
        .text();
    let rows: Vec<&str> = csv.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(rows.len(), 102, "{}", rows[0]);
    for column in [
        "time_s",
        "p_ch_bar_gauge",
        "p_ch_model_bar_gauge",
        "p_ch_residual_bar_diff",
    ] {
        assert!(rows[0].split(',').any(|cell| cell == column), "{}", rows[0]);
    }

    let aligned = browser
        .get(&format!("{session}/logs/2/alignment?with=1&signal=p_ch"))
        .json();
    assert!(
        aligned["correlation"].as_f64().unwrap().abs() <= 1.0,
        "{aligned}"
    );

    // With another plant, the comparison is dropped.
    browser.put(
        &format!("{session}/strictness"),
        &json!({"allowed_noise_multiples": 1000.0, "tolerances": {}}),
    );
    assert_eq!(
        browser.get(&format!("{session}/logs/1/comparison")).status,
        409
    );
    assert_eq!(browser.compare(&session, 1)["state"], "done");
    assert_eq!(
        browser.get(&format!("{session}/logs/1/comparison")).json()["verdict"]["holds"],
        true
    );
}

#[test]
fn values_out_of_range_are_refused_with_what_is_allowed() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    browser.post(
        &format!("{session}/examples/leakdown-aluminium"),
        &json!({"keep": false}),
    );
    assert_eq!(browser.compare(&session, 1)["state"], "done");
    for path in [
        "traces?points=100&from_s=9&to_s=3",
        "traces?points=100&from_s=nan&to_s=3",
        "traces?points=many",
        "traces",
        "traces?points=100&select=p_ch/nothing/x",
        "traces?points=100&select=",
        "values",
        "scatter?signal=nothing&over=time",
        "scatter?signal=p_ch&over=nothing",
        "fold?signal=p_ch&period_ms=0",
        "fold?signal=p_ch&period_ms=-1",
        "alignment?with=9&signal=p_ch",
        "csv?from_s=1e9&to_s=2e9",
    ] {
        let answer = browser.get(&format!("{session}/logs/1/{path}"));
        assert!(matches!(answer.status, 400 | 404), "{path}: {answer:?}");
    }
    for (path, body) in [
        ("logs/1/offset", json!({"offset_s": 1e9})),
        ("logs/1/offset", json!({"offset_s": null})),
        ("logs/9/offset", json!({"offset_s": 1})),
        (
            "strictness",
            json!({"allowed_noise_multiples": 0, "tolerances": {}}),
        ),
        (
            "strictness",
            json!({"allowed_noise_multiples": 1, "tolerances": {"p_ch": -1}}),
        ),
        (
            "strictness",
            json!({"allowed_noise_multiples": 1, "tolerances": {}, "more": 1}),
        ),
    ] {
        let answer = browser.put(&format!("{session}/{path}"), &body);
        assert!(
            matches!(answer.status, 400 | 404 | 422),
            "{path}: {answer:?}"
        );
    }
    let project = project(&browser, &session);
    assert_eq!(project["logs"][0]["offset_s"], 0.0);
}

/// The reader's own corpus of wrong files and its MF4 files, whole and cut: each gives its code, and the server
/// continues.
#[test]
fn every_file_is_read_or_refused_and_the_server_goes_on() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let tests = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../recording/tests");
    let mut refused = 0;
    for folder in ["corpus/wrong", "corpus/good", "fixtures/mf4"] {
        for entry in std::fs::read_dir(tests.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let bytes = std::fs::read(&path).unwrap();
            for part in [&bytes[..], &bytes[..bytes.len() / 2]] {
                let added = browser.upload(&session, "log", part);
                assert_eq!(added.status, 200, "{}", path.display());
                let problem = added.json()["project"]["logs"][0]["problem"].clone();
                if problem != Value::Null {
                    refused += 1;
                    let code = problem["code"].as_str().unwrap();
                    assert!(
                        code.starts_with("E-CSV-") || code.starts_with("E-MF4-"),
                        "{code}"
                    );
                } else if folder == "corpus/wrong" {
                    assert!(part.len() < bytes.len(), "{} was read", path.display());
                }
                let number = &added.json()["log"];
                let preview = browser.get(&format!("{session}/logs/{number}/preview"));
                assert_eq!(preview.status, 200, "{}", path.display());
                let removed = browser.send(
                    "DELETE",
                    &format!("{session}/logs/{number}"),
                    "text/plain",
                    b"",
                );
                assert_eq!(removed.status, 200);
            }
        }
    }
    assert!(refused > 60, "{refused}");
}

#[test]
fn an_mf4_log_is_a_log_and_its_channels_can_be_chosen() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../recording/tests/fixtures/mf4/rates-transposed.mf4");
    let added = browser
        .upload(&session, "rates.mf4", &std::fs::read(path).unwrap())
        .json();
    let log = &added["project"]["logs"][0];
    assert_eq!(log["problem"], Value::Null, "{log}");
    assert!(!log["summary"]["signals"].as_array().unwrap().is_empty());
    let preview = browser.get(&format!("{session}/logs/1/preview")).json();
    let inspection = &preview["inspection"];
    assert_eq!(inspection["format"], "MF4", "{inspection}");
    assert!(
        inspection["columns"].as_array().unwrap().len() > 3,
        "{inspection}"
    );
    let traces = browser.get(&format!("{session}/logs/1/traces?points=300"));
    assert_eq!(traces.status, 200, "{traces:?}");
    let mf4 = browser.get(&format!("{session}/logs/1/mf4"));
    assert!(mf4.body.starts_with(b"MDF "), "{:?}", mf4.head);
}

/// The page has no table of its own: signals, units and reasons are those of `retarder inspect`.
#[test]
fn a_preview_has_the_inspection_with_the_reason_of_each_guess() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/unknown/german-logger.csv");
    let bytes = std::fs::read(&path).unwrap();
    browser.upload(&session, "german.csv", &bytes);
    let preview = |query: &str| {
        let answer = browser.get(&format!("{session}/logs/1/preview{query}"));
        answer.json()["inspection"].clone()
    };
    let open = preview("");
    assert_eq!(open["source"], "german.csv");
    assert_eq!(
        (&open["asks_reference"], &open["suggested"]),
        (&json!(true), &json!("gauge"))
    );
    let columns = open["columns"].as_array().unwrap();
    let pressure = columns
        .iter()
        .find(|column| column["signal"] == "p_ch")
        .unwrap();
    assert!(
        pressure["reason"]
            .as_str()
            .unwrap()
            .contains("name contains"),
        "{pressure}"
    );

    let answered = preview("?pressure=gauge");
    assert_eq!(answered["is_ready"], true, "{answered}");
    let form = json!({"toml": answered["mapping"]});
    let mapped = browser
        .put(&format!("{session}/logs/1/mapping"), &form)
        .json();
    assert_eq!(mapped["logs"][0]["problem"], Value::Null, "{mapped}");
    // A second inspection keeps the mapping and has nothing to add.
    let again = preview("");
    assert_eq!(
        (&again["mapping"], &again["is_ready"]),
        (&Value::Null, &json!(true)),
        "{again}"
    );
}

/// A header such as `p_ch [bar]` needs only its reference, which the mapping of the page states.
#[test]
fn the_answer_to_the_reference_is_written_into_the_mapping() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let log =
        b"time_s,p_ch [bar],duty_fill_pct,duty_vent_pct\n0,3.5,0,0\n0.01,3.5,0,0\n0.02,3.5,0,0\n";
    browser.upload(&session, "bar.csv", log);
    let preview = browser.get(&format!("{session}/logs/1/preview?pressure=absolute"));
    let inspection = &preview.json()["inspection"];
    assert_eq!(inspection["mapping"], Value::Null, "{inspection}");
    let form = json!({"toml": inspection["mapping_with_reference"]});
    let mapped = browser
        .put(&format!("{session}/logs/1/mapping"), &form)
        .json();
    let signals = &mapped["logs"][0]["summary"]["signals"];
    assert_eq!(signals[0]["reference"], "absolute", "{mapped}");
}

/// A calculated channel is a signal like others, saved with the project and exported with the data.
#[test]
fn calculated_channels_are_signals_of_every_log_that_has_what_they_need() {
    let bench = Bench::start();
    let browser = bench.browser();
    let session = browser.session(None);
    let log = b"time_s,p_a_bar_gauge,p_b_bar_gauge\n0,3,1\n1,5,1\n2,,1\n";
    browser.upload(&session, "both.csv", log);
    browser.upload(&session, "one.csv", b"time_s,p_a_bar_gauge\n0,3\n1,5\n");
    let set = |channels: Value| browser.put(&format!("{session}/calculated"), &channels);
    let dp = json!({"name": "dp <b>", "unit": "bar_diff", "formula": "p_a - p_b"});
    let half = json!({"name": "half", "unit": "bar_diff", "formula": "\"dp <b>\" / 2"});
    let project = set(json!([dp, half])).json();
    assert_eq!(project["calculated"], json!([dp, half]));
    let names = |log: usize| {
        let signals = project["logs"][log]["summary"]["signals"]
            .as_array()
            .unwrap();
        signals
            .iter()
            .map(|one| one["name"].as_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(0), ["p_a", "p_b", "dp <b>", "half"]);
    assert_eq!(names(1), ["p_a"]);
    let reason = &project["logs"][1]["summary"]["left_out"][0]["reason"];
    assert!(reason.as_str().unwrap().contains("\"p_b\""), "{reason}");

    let traces = browser
        .get(&format!("{session}/logs/1/traces?points=10"))
        .json();
    let half = &traces["signals"][3];
    assert_eq!(half["measured"]["y"], json!([1.0, 2.0, null]));
    let csv = browser.get(&format!("{session}/logs/1/csv")).text();
    assert!(
        csv.lines().any(|line| line.starts_with("0,3,1,2,1")),
        "{csv}"
    );

    for (wrong, line, column) in [
        (
            json!([dp, {"name": "x", "unit": "bar_diff", "formula": "p_a - "}]),
            2,
            json!(7),
        ),
        (
            json!([{"name": "x", "unit": "bar_diff", "formula": "sinus(p_a)"}]),
            1,
            json!(1),
        ),
        (
            json!([{"name": "x", "unit": "nothing", "formula": "p_a"}]),
            1,
            Value::Null,
        ),
        (json!([dp, dp]), 2, Value::Null),
        (
            json!([{"name": "a\u{202e}", "unit": "bar_diff", "formula": "p_a"}]),
            1,
            Value::Null,
        ),
    ] {
        let answer = set(wrong);
        assert_eq!(answer.status, 422, "{answer:?}");
        let problem = &answer.json()["problems"][0];
        assert_eq!(
            (&problem["line"], &problem["column"]),
            (&json!(line), &column),
            "{problem}"
        );
    }
    let long = "p_a+".repeat(1000);
    let answer = set(json!([{"name": "x", "unit": "bar_diff", "formula": long}]));
    assert_eq!(answer.status, 422);
    let many: Vec<Value> = (0..40)
        .map(|index| json!({"name": format!("n{index}"), "unit": "bar_diff", "formula": "p_a"}))
        .collect();
    assert_eq!(set(json!(many)).status, 400);

    // The refused request changed nothing, and the channels are there after a restart.
    let id = session.rsplit('/').next().unwrap().to_owned();
    let bench = bench.restart();
    let browser = bench.browser();
    let session = browser.session(Some(&id));
    let project = browser.get(&format!("{session}/project")).json();
    assert_eq!(project["calculated"].as_array().unwrap().len(), 2);
    assert_eq!(
        project["logs"][0]["summary"]["signals"]
            .as_array()
            .unwrap()
            .len(),
        4
    );
}
