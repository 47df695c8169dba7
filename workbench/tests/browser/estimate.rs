//! Page "Estimate": statements about values, the estimation with its pictures, the edited tables, and undo.

use serde_json::{Value, json};

use crate::driver::{Person, with_browser};
use crate::layout::set_page_size;
use crate::refine::{DIAGNOSIS, LAST_BAR, last_bar};

/// Whether both pictures have the width of their place, which the charting library adapts a moment after the window.
const FITS: &str = "[...document.querySelectorAll('#interval-plot, #correlation-plot')].every((chart) => \
    chart.querySelector('.main-svg').clientWidth === chart.clientWidth)";
const STEPS: &str = "document.querySelectorAll('#steps li').length";

async fn open_estimate(person: &Person) {
    person.open_example().await;
    go_to(person, "estimate").await;
}

async fn go_to(person: &Person, page: &str) {
    person.click(&format!("nav a[href^='#/{page}']")).await;
    person
        .until(&format!("document.body.dataset.ready === '{page}'"))
        .await;
}

async fn value_of(person: &Person, name: &str) -> Value {
    let field = format!("return document.querySelector(\"[data-value='{name}']\").value");
    person.run(&field).await
}

/// Chooses what is known of a value, as a user does.
async fn state(person: &Person, name: &str, known: &str) {
    person.fill(&format!("[data-known='{name}']"), known).await;
}

#[test]
fn a_fixed_value_stays_while_the_others_are_estimated_and_pictures_show_the_result() {
    const FIXED: &str = "flow.discharge_vent";
    const MOVED: &str = "flow.discharge_fill";
    with_browser(async |person| {
        open_estimate(person).await;
        let (fixed, moved) = (value_of(person, FIXED).await, value_of(person, MOVED).await);
        state(person, FIXED, "fixed").await;
        person.until(&format!("{STEPS} === 2")).await;
        let row = person.text(&format!("[data-parameter='{FIXED}']")).await;
        assert!(row.contains("does not move"), "{row}");

        // The error is drawn while it falls, also after another page was shown.
        person.click("#estimate").await;
        let points = "document.getElementById('live-error-plot').data?.[0].x.length";
        person
            .until_within(DIAGNOSIS, &format!("{points} >= 2"))
            .await;
        assert!(person.text("#live-error").await.contains("× noise floor"));
        person.picture("estimate-live").await;
        go_to(person, "logs").await;
        go_to(person, "estimate").await;
        person
            .until(&format!(
                "{points} >= 2 || !document.getElementById('estimation').hidden"
            ))
            .await;

        person
            .until_within(
                DIAGNOSIS,
                "document.querySelectorAll('#estimated tbody tr').length > 10",
            )
            .await;
        assert_eq!(value_of(person, FIXED).await, fixed);
        assert_ne!(value_of(person, MOVED).await, moved);
        let table = person.text("#estimated").await;
        assert!(
            table.contains(MOVED) && table.contains("armature.preload_vent_n"),
            "{table}"
        );
        assert!(
            table.contains("only with") && !table.contains(FIXED),
            "{table}"
        );

        person.until("document.querySelector('#interval-plot .main-svg') && document.querySelector('#correlation-plot .main-svg')").await;
        let shown: (usize, usize, f64) = serde_json::from_value(person.run(
            "const intervals = document.getElementById('interval-plot').data; const map = document.getElementById('correlation-plot').data[0]; \
             return [intervals[1].y.length + intervals[2].y.length, map.z.length, map.z[0][0]]",
        ).await).unwrap();
        assert!(
            shown.0 > 8 && shown.1 == shown.0 && shown.2 == 1.0,
            "{shown:?}"
        );
        let inside = "const [, one, two] = document.getElementById('interval-plot').data; \
                      return [...one.x, ...two.x].every((x) => x > -0.001 && x < 100.001)";
        assert_eq!(person.run(inside).await, json!(true));
        for size in [(1280, 800), (800, 600)] {
            set_page_size(person, size).await;
            person.until(FITS).await;
            for theme in ["light", "dark"] {
                for part in [
                    "parameters",
                    "interval-plot",
                    "correlation-plot",
                    "estimated",
                    "tables",
                ] {
                    let scroll = "document.getElementById(arguments[0]).scrollIntoView()";
                    person.run_with(scroll, vec![json!(part)]).await;
                    person.draw().await;
                    person
                        .picture_of_window(&format!("estimate-{part}-{}-{theme}", size.0))
                        .await;
                }
                // Wide tables scroll inside of their card.
                let is_wide = "return document.documentElement.scrollWidth > document.documentElement.clientWidth";
                assert_eq!(person.run(is_wide).await, json!(false), "{size:?}");
                person.run("scrollTo(0, 0)").await;
                person.click("#theme").await;
            }
        }

        set_page_size(person, (1280, 820)).await;
        person.until(FITS).await;
        person
            .run("document.getElementById('estimation').scrollIntoView()")
            .await;
        person.draw().await;
        person.picture_of_window("page-estimate").await;
        person.run("scrollTo(0, 0)").await;

        // The plant file carries the statement.
        let toml = person
            .client
            .execute_async(
                "const done = arguments[0]; fetch(document.getElementById('download-plant').href).then((answer) => answer.text()).then(done);",
                vec![],
            )
            .await
            .unwrap();
        let toml = toml.as_str().unwrap();
        let line = toml.lines().find(|line| line.starts_with("discharge_vent"));
        assert!(line.unwrap().contains("exact = true"), "{line:?}");

        // Undone, the values are as before, and there is no estimation.
        person.click("#undo").await;
        person
            .until("document.getElementById('estimation').hidden")
            .await;
        assert_eq!(value_of(person, MOVED).await, moved);
        person.click("#undo").await;
        person
            .until(&format!(
                "document.querySelector(\"[data-known='{FIXED}']\").value === 'opened'"
            ))
            .await;
        person.assert_nothing_was_refused().await;
    });
}

#[test]
fn an_estimation_is_a_step_of_refine_and_an_experiment_is_planned_for_it() {
    with_browser(async |person| {
        open_estimate(person).await;
        person.click("#estimate").await;
        person
            .until_within(
                DIAGNOSIS,
                "document.querySelectorAll('#estimated tbody tr').length > 10",
            )
            .await;
        person.click("#plan-determining").await;
        person
            .until_within(
                DIAGNOSIS,
                "document.querySelector('#determining-plot .main-svg')",
            )
            .await;
        let answer = person.text("#determining").await;
        assert!(answer.contains("Duty cycles as CSV"), "{answer}");
        person.picture("determining").await;

        go_to(person, "refine").await;
        person
            .until("document.querySelector('#error-steps .rung:nth-of-type(2) h3')?.textContent === 'ordinary parameters refitted'")
            .await;
        // The axis is logarithmic: two errors in a ratio are as far apart anywhere.
        let widths: Vec<(f64, f64)> = serde_json::from_value(person.run(
            "return [...document.querySelectorAll('#error-steps .bar-row[data-times]')].map((row) => \
             [Number(row.dataset.times), parseFloat(row.querySelector('.fill').style.width)]).filter(([times]) => times > 0.5)",
        ).await).unwrap();
        let (first, second) = (widths[0], widths[widths.len() - 1]);
        let slope = (first.1 - second.1) / (first.0 / second.0).ln();
        for (times, width) in &widths {
            let expected = second.1 + slope * (times / second.0).ln();
            assert!((width - expected).abs() < 0.1, "{widths:?}");
        }

        // One refitted value is switched back, and the error follows.
        let last = last_bar(person).await;
        let switch = "document.querySelector(\"[data-refitted='flow.discharge_fill']\").click()";
        person.run(switch).await;
        person
            .until(&format!("Math.abs({LAST_BAR} - {last}) > 0.001 * {last}"))
            .await;
        let step = person.text("#steps [aria-current]").await;
        assert!(
            step.contains("flow.discharge_fill") && step.contains("as opened"),
            "{step}"
        );
        person.picture("refitted").await;
        person.click("#undo").await;
        person
            .until(&format!("Math.abs({LAST_BAR} - {last}) < 1e-9"))
            .await;
        person.assert_nothing_was_refused().await;
    });
}

#[test]
fn statements_and_tables_are_edited_refused_beside_the_entry_and_undone() {
    const VOLUME: &str = "chamber.volume_m3";
    with_browser(async |person| {
        open_estimate(person).await;
        let known = format!("[data-known='{VOLUME}']");
        let problem = format!(
            "document.querySelector(\"[data-parameter='{VOLUME}'] .problem:not([hidden])\")"
        );
        state(person, VOLUME, "tolerance").await;
        person.until(&format!("{STEPS} === 2")).await;
        person
            .fill(&format!("[data-tolerance='{VOLUME}']"), "-5")
            .await;
        person.until(&problem).await;
        let said = person
            .text(&format!("[data-parameter='{VOLUME}'] .problem"))
            .await;
        assert!(said.contains("a tolerance of -5 is none"), "{said}");
        person
            .fill(&format!("[data-tolerance='{VOLUME}']"), "5")
            .await;
        person.until(&format!("!{problem} && {STEPS} === 3")).await;
        state(person, VOLUME, "range").await;
        person.until(&format!("{STEPS} === 4")).await;
        person.fill(&format!("[data-low='{VOLUME}']"), "2").await;
        person.until(&problem).await;
        // A refused entry stays, and the plant does not change.
        assert_eq!(person.run(&format!("return {STEPS}")).await, json!(4));
        person.click("#undo").await;
        person
            .until(&format!(
                "!{problem} && document.querySelector(\"{known}\").value === 'tolerance'"
            ))
            .await;

        // An own effect: a mistake has its line, and the mended text is a step.
        person.click("#insert-effect").await;
        let replace = "const text = document.getElementById('tables'); text.value = text.value.replace(arguments[0], arguments[1])";
        person
            .run_with(replace, vec![json!("k * max"), json!("k ** max")])
            .await;
        person.click("#apply-tables").await;
        person
            .until("document.querySelector('#tables-problems .problem')")
            .await;
        let said = person.text("#tables-problems").await;
        assert!(
            said.starts_with("line ") && said.contains("expression"),
            "{said}"
        );
        person.click("#tables-problems .link").await;
        let selected = "const text = document.getElementById('tables'); return text.value.slice(text.selectionStart, text.selectionEnd)";
        let line = person.run(selected).await;
        assert!(
            line.as_str()
                .unwrap()
                .starts_with("expression = \"k ** max"),
            "{line}"
        );
        person
            .run_with(replace, vec![json!("k ** max"), json!("k * max")])
            .await;
        person.click("#apply-tables").await;
        person
            .until("document.querySelector(\"[data-parameter='effects.own.lifting_seal.k']\")")
            .await;
        assert_eq!(
            person
                .run("return document.querySelectorAll('#tables-problems li').length")
                .await,
            json!(0)
        );
        person.picture("estimate-tables").await;
        person.click("#undo").await;
        person
            .until("!document.getElementById('tables').value.includes('lifting_seal')")
            .await;
        person.assert_nothing_was_refused().await;
    });
}
