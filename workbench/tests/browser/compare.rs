//! Workflow of a new user: a log is dropped, compared, examined, marked, exported, and shared as a link.

use std::collections::BTreeSet;

use serde_json::json;

use crate::driver::{Person, with_browser};

const ID: &str = include_str!("../../../data/synthetic/practice-01-id.csv");
const CHECK: &str = include_str!("../../../data/synthetic/practice-01-check.csv");

/// Returns the range of the chart's time axis (s).
async fn range(person: &Person) -> (f64, f64) {
    let range = person
        .run("return document.getElementById('time-plots').layout.xaxis.range")
        .await;
    (range[0].as_f64().unwrap(), range[1].as_f64().unwrap())
}

#[test]
fn a_dropped_log_is_compared_and_looked_at_from_all_sides() {
    with_browser(async |person| {
        person
            .drop_files(&[("practice-01-id.csv", ID), ("practice-01-check.csv", CHECK)])
            .await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;
        person.picture("logs").await;
        person.compare("practice-01-id.csv").await;
        let verdict = person.text("#verdict").await;
        assert!(
            verdict.contains("unexplained") && verdict.contains("p_ch"),
            "{verdict}"
        );
        person.picture("compare").await;

        // Keys zoom and move; the chart follows at once and the numbers after it.
        let (from, to) = range(person).await;
        person.press("#time-plots", "+").await;
        person
            .until(&format!(
                "document.getElementById('time-plots').layout.xaxis.range[1] < {to}"
            ))
            .await;
        let (zoomed_from, zoomed_to) = range(person).await;
        assert!(((zoomed_to - zoomed_from) / (to - from) - 0.5).abs() < 1e-6);
        person.until("document.querySelector('#metrics td').textContent.length < 6 && !document.querySelector('#metrics td').textContent.startsWith('6')").await;

        // Two cursors, with the differences of time and of every signal.
        person.fill("#cursor-a", "20").await;
        person.fill("#cursor-b", "22.5").await;
        person.until("document.getElementById('cursors-title').parentElement.textContent.includes('+2.5')").await;
        person.until("[...document.querySelectorAll('#values tbody tr')].every((row) => row.cells[2].textContent !== '–' && row.cells[4].textContent !== '–')").await;

        // A click on a regime marks its samples in the plots, and so does a click on a cell of the map.
        person
            .click("[data-select='p_ch/valve_state/filling']")
            .await;
        person.until("document.getElementById('time-plots').layout.shapes.some((shape) => shape.type === 'path')").await;
        person
            .until("document.getElementById('scatter').data[1].x.length > 0")
            .await;
        person.picture("compare-marked").await;

        // The address contains the view: a second tab that opens it shows the same view.
        let link = person.client.current_url().await.unwrap().to_string();
        for part in ["log=1", "from=", "a=20", "select=p_ch"] {
            assert!(link.contains(part), "{link}");
        }
        let seen = range(person).await;
        let tab = person.client.new_window(true).await.unwrap();
        person.client.switch_to_window(tab.handle).await.unwrap();
        person.client.goto(&link).await.unwrap();
        person
            .until("document.body.dataset.ready === 'compare'")
            .await;
        assert_eq!(range(person).await, seen);
        person
            .until("document.getElementById('cursor-b').value === '22.5'")
            .await;
        person.watch_the_policy().await;

        person
            .until("['scatter', 'fold', 'distribution', 'spectrum'].every((look) => document.getElementById(look).data)")
            .await;
        // Every chart as an image, under the page's own content policy, and the data as two kinds of log.
        person
            .run(
                "window.saved = []; \
                 HTMLAnchorElement.prototype.click = function () { saved.push([this.download, this.href]); }; \
                 for (const button of document.querySelectorAll('button')) if (/^(PNG|SVG|CSV of.*|MF4 of.*)$/.test(button.textContent)) button.click();",
            )
            .await;
        person.until("saved.length === 12").await;
        let saved: Vec<(String, String)> =
            serde_json::from_value(person.run("return saved").await).unwrap();
        let names: BTreeSet<_> = saved.iter().map(|(name, _)| name).collect();
        assert_eq!(names.len(), 12, "{names:?}");
        for (name, url) in &saved {
            assert!(
                name.starts_with("practice-01-id-csv_nominal-plant-toml_"),
                "{name}"
            );
            let begin = match name.rsplit('.').next().unwrap() {
                "png" => "data:image/png;base64,",
                "svg" => "data:image/svg+xml,",
                _ => "http://127.0.0.1:",
            };
            assert!(url.starts_with(begin), "{name}: {url:.80}");
            assert!(
                !url.starts_with("data:") || url.len() > 5000,
                "{name}: {} bytes",
                url.len()
            );
        }

        // An image has log, plant and signals in its title, and a legend of its lines.
        let drawn = "return decodeURIComponent(saved.find(([name]) => /_p_ch-.*svg$/.test(name) || /_\\d-signals.svg$/.test(name))[1])";
        let drawn = person.run(drawn).await;
        for part in [
            "practice-01-id.csv, plant nominal-plant.toml: ",
            "measured − modelled",
            ">modelled<",
            ">fill valve<",
        ] {
            assert!(drawn.as_str().unwrap().contains(part), "{part}");
        }

        person.click("#theme").await;
        person
            .until("document.documentElement.dataset.theme === 'dark'")
            .await;
        person.picture("compare-dark").await;
        person.assert_nothing_was_refused().await;
    });
}

/// Waits for the card of a log and asserts that it has a gauge pressure.
async fn assert_pressure_is_read(person: &Person) {
    person
        .until("document.querySelector('.log .signals')")
        .await;
    let chips = person.text(".log .signals").await;
    assert!(
        chips.contains("p_ch") && chips.contains("bar gauge"),
        "{chips}"
    );
}

#[test]
fn an_unknown_log_opens_with_its_inspection_and_one_answer_makes_it_a_log() {
    with_browser(async |person| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../data/unknown/german-logger.csv");
        person
            .drop_bytes("german.csv", &std::fs::read(path).unwrap())
            .await;
        person
            .until("document.querySelector('.inspection tbody tr')")
            .await;
        let shown = person.text(".inspection").await;
        assert!(
            shown.contains("name contains") && shown.contains("neither gauge nor absolute"),
            "{shown}"
        );
        person.picture("inspection").await;
        // The form below has the same guesses.
        let guessed = "[...document.querySelectorAll('.mapping .form [aria-label^=signal]')].map((one) => one.value)";
        let names = person.run(&format!("return {guessed}.join(' ')")).await;
        assert!(names.as_str().unwrap().contains("p_ch"), "{names}");
        person.click("[data-reference=gauge]").await;
        assert_pressure_is_read(person).await;
        person.assert_nothing_was_refused().await;
    });
}

#[test]
fn a_log_without_header_is_explained_in_the_form_and_read() {
    with_browser(async |person| {
        person
            .drop_files(&[("wild.csv", "0;1,5\n0,5;1,6\n1;1,7\n")])
            .await;
        person.until("document.querySelector('.mapping')").await;
        person.picture("mapping").await;
        person
            .run(
                "const rows = document.querySelectorAll('.form tbody tr'); \
                 const say = (row, role, name, unit) => { \
                   const [select, signal, unitField] = ['use', 'signal', 'unit'].map((label) => row.querySelector(`[aria-label^='${label} of']`)); \
                   select.value = role; select.dispatchEvent(new Event('change')); \
                   signal.value = name; unitField.value = unit; unitField.dispatchEvent(new Event('input')); }; \
                 say(rows[0], 'time', '', 's'); say(rows[1], 'signal', 'p_ch', 'bar');",
            )
            .await;
        // What is missing is said beside the row, and two buttons answer it.
        person.click(".apply-mapping").await;
        let note = "document.querySelectorAll('.form tbody tr')[1].cells[4].textContent";
        person
            .until(&format!("{note}.startsWith('Gauge or absolute?')"))
            .await;
        let needed = person.text(".needed").await;
        assert!(
            needed.contains("duty_fill") && needed.contains("p_ch"),
            "{needed}"
        );
        person.picture("mapping-problem").await;
        person.click(".form .reference").await;
        person.click(".apply-mapping").await;
        assert_pressure_is_read(person).await;
        person.assert_nothing_was_refused().await;
    });
}

/// Defect seen: the form for columns opened for a file in which no column can be mapped.
#[test]
fn no_mapping_is_proposed_for_an_empty_or_a_truncated_file() {
    with_browser(async |person| {
        let cut = "time_s,p_ch_bar_gauge,i_fill_mA\n0.00,1.50,2.5\n0.01,1.50,2.5\n0.02,1.5";
        person
            .drop_files(&[("empty.csv", ""), ("cut.csv", cut)])
            .await;
        person
            .until("document.querySelectorAll('.log.wrong .problem').length === 2 && document.querySelector('.inspection')")
            .await;
        assert_eq!(
            person
                .run("return document.querySelectorAll('.mapping').length")
                .await,
            json!(0)
        );
        let next = person.text(".next").await;
        assert!(next.contains("open a complete log"), "{next}");
        person.picture("beyond-mapping").await;
        let said = person.text("[data-name='cut.csv'] .problem").await;
        assert!(said.contains("E-CSV-TRUNCATED"), "{said}");
        let all = person.text("[data-name='cut.csv'] .others").await;
        assert!(all.contains("line 4 has 2 fields"), "{all}");
    });
}

#[test]
fn a_log_that_knows_when_it_began_says_so() {
    with_browser(async |person| {
        let started = include_bytes!("../../../recording/tests/fixtures/mf4/started.mf4");
        person.drop_bytes("started.mf4", started).await;
        person.until("document.querySelector('.log .facts')").await;
        let facts = person.text(".log .facts").await;
        assert!(
            facts.starts_with("recorded 2024-05-03 16:12:07 UTC+02:00 · 3 samples"),
            "{facts}"
        );
    });
}

#[test]
fn other_logs_lie_beside_and_are_brought_onto_this_one() {
    with_browser(async |person| {
        let late: String = ID
            .lines()
            .map(|line| match line.split_once(',') {
                Some((time, rest)) => match time.parse::<f64>() {
                    Ok(time) => format!("{:.2},{rest}\n", time + 3.0),
                    Err(_) => format!("{line}\n"),
                },
                None => String::new(),
            })
            .collect();
        person
            .drop_files(&[("now.csv", ID), ("late.csv", &late)])
            .await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;
        person.compare("now.csv").await;
        let traces = person
            .run("return document.getElementById('time-plots').data.length")
            .await;
        person.click_in_menu("signals", "[data-overlay='2']").await;
        person
            .until(&format!(
                "document.getElementById('time-plots').data.length > {traces}"
            ))
            .await;
        person.run("[...document.querySelectorAll('button')].find((one) => one.textContent === 'Align').click()").await;
        let offset = "Math.abs(Number(document.querySelector('[aria-label=\"offset of late.csv\"]').value) + 3)";
        person.until(&format!("{offset} < 0.01")).await;
        person
            .until("[...document.querySelectorAll('#differences tbody tr')].some((row) => row.cells[0].textContent === 'p_ch − late.csv' && Number(row.cells[2].textContent) < 0.01)")
            .await;
        let sizes = "[...document.querySelectorAll('#metrics, #differences')].map((one) => one.parentElement).every((card) => card.scrollWidth <= card.clientWidth)";
        assert_eq!(person.run(&format!("return {sizes}")).await, json!(true));
        person.picture("compare-overlay").await;

        // Differences are also drawn beside the view, like all time series, so that moving shows no empty edge.
        for _ in 0..2 {
            person.press("#time-plots", "+").await;
        }
        let (from, to) = range(person).await;
        assert!(from > 20.0 && to < 40.0, "{from} s to {to} s");
        person
            .until(&format!(
                "document.getElementById('time-plots').data.every(({{ x }}) => x[0] > 10 && x[0] < {from} - 5 && x.at(-1) > {to} + 5 && x.at(-1) < 50)"
            ))
            .await;
        person.press("#time-plots", "Home").await;
        person
            .until("document.getElementById('time-plots').data.every(({ x }) => x[0] < 4)")
            .await;

        // A drag with Ctrl moves the log; the view stays.
        let seen = range(person).await;
        let aligned = person
            .run("return Number(document.querySelector('[aria-label=\"offset of late.csv\"]').value)")
            .await
            .as_f64()
            .unwrap();
        person
            .run(
                "const chart = document.getElementById('time-plots'); const box = chart.getBoundingClientRect(); \
                 const at = (type, x) => chart.dispatchEvent(new PointerEvent(type, { bubbles: true, pointerId: 1, ctrlKey: true, clientX: box.left + x, clientY: box.top + 60 })); \
                 chart.setPointerCapture = () => {}; at('pointerdown', 300); at('pointermove', 330); at('pointermove', 360); at('pointerup', 360);",
            )
            .await;
        let moved = format!(
            "(Number(document.querySelector('[aria-label=\"offset of late.csv\"]').value) - ({aligned}))"
        );
        person.until(&format!("{moved} > 1")).await;
        let share = 60.0 / person
            .run("return document.getElementById('time-plots').getBoundingClientRect().width - 78")
            .await
            .as_f64()
            .unwrap();
        let by = person
            .run(&format!("return {moved}"))
            .await
            .as_f64()
            .unwrap();
        assert!((by - share * (seen.1 - seen.0)).abs() < 0.01, "{by}");
        assert_eq!(range(person).await, seen);
        assert_eq!(person.run("return window.refused").await, json!([]));
    });
}

/// Defect seen: a problem in red stood above an inspection that had recognised every column.
#[test]
fn no_problem_stands_above_an_inspection_that_recognised_every_column() {
    with_browser(async |person| {
        let log = "Messung 12\nStand 3\nZeit (ms);Kammerdruck (barg);PWM fill (%);PWM vent (%)\n0;1,5;0;0\n10;1,6;50;0\n20;1,7;50;0\n30;1,8;50;0\n";
        person.drop_files(&[("bench.csv", log)]).await;
        person
            .until("document.querySelector('.log .inspection tbody tr')")
            .await;
        let card = person.text(".log").await;
        assert!(card.contains("All columns are recognised"), "{card}");
        let red = "return document.querySelectorAll('.log.wrong, .log .problem').length";
        assert_eq!(person.run(red).await, json!(0), "{card}");
        person.click(".use-inspection").await;
        assert_pressure_is_read(person).await;
    });
}
