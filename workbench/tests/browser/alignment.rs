//! Time offset of an overlaid log: a weak correlation is proposed, and number and slider agree.

use serde_json::json;

use crate::driver::{Person, with_browser};

const ID: &str = include_str!("../../../data/synthetic/practice-01-id.csv");
const FIELD: &str = "document.querySelector('[aria-label=\"offset of unrelated.csv\"]')";
const SLIDER: &str = "document.querySelector('[aria-label=\"drag the offset of unrelated.csv\"]')";

/// Returns the log with another pressure, which has nothing in common with it.
fn unrelated() -> String {
    let mut state = 1_u32;
    let mut out = String::new();
    for line in ID.lines() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if cells.len() > 3 && cells[0].parse::<f64>().is_ok() {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            cells[3] = format!("{:.4}", f64::from(state >> 16) / 16384.0);
        }
        out += &cells.join(",");
        out.push('\n');
    }
    out
}

async fn offset(person: &Person) -> f64 {
    let value = person.run(&format!("return Number({FIELD}.value)")).await;
    value.as_f64().unwrap()
}

#[test]
fn a_weak_correlation_is_proposed_and_number_and_slider_agree() {
    with_browser(async |person| {
        person
            .drop_files(&[("now.csv", ID), ("unrelated.csv", &unrelated())])
            .await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;
        person.compare("now.csv").await;
        person.run("[...document.querySelectorAll('button')].find((one) => one.textContent === 'Align').click()").await;
        person.until("document.querySelector('.apply-weak')").await;
        let note = person.text(".alignment").await;
        assert!(note.starts_with("not applied: correlation 0."), "{note}");
        assert_eq!(offset(person).await, 0.0, "{note}");

        // The user applies it; the slider follows, also where its range ended before.
        let proposed = person.text(".apply-weak").await;
        let proposed: f64 = proposed
            .trim_start_matches("Apply ")
            .trim_end_matches(" s")
            .replace('−', "-")
            .parse()
            .unwrap();
        person.click(".apply-weak").await;
        person
            .until(&format!("Math.abs({FIELD}.value - ({proposed})) < 0.01"))
            .await;
        let agree = format!("{FIELD}.value === {SLIDER}.value");
        person.until(&agree).await;
        for far in ["25", "-31.5"] {
            person
                .fill("[aria-label='offset of unrelated.csv']", far)
                .await;
            person.until(&format!("{FIELD}.value === '{far}'")).await;
            assert_eq!(
                person.run(&format!("return {agree}")).await,
                json!(true),
                "{far}"
            );
        }

        // A fast drag ends at its last position, on the page and in the project.
        person
            .run(&format!(
                "for (let step = 0; step < 40; step++) {{ {SLIDER}.value = -31.5 + 0.05 * step; {SLIDER}.dispatchEvent(new Event('input')); }}"
            ))
            .await;
        person
            .until(&format!("Math.abs({FIELD}.value - -29.55) < 1e-6"))
            .await;
        assert_eq!(person.run(&format!("return {agree}")).await, json!(true));
        person
            .until(
                "(fetch(`/api/sessions/${sessionStorage.getItem('project')}/project`).then((answer) => answer.json()) \
                   .then(({ logs }) => { window.stored = logs[1].offset_s; }), Math.abs(window.stored + 29.55) < 1e-6)",
            )
            .await;
    });
}
