//! Detail charts of the page "Compare": statistics, valve states behind the plots, tolerances, long lists.

use serde_json::json;

use crate::driver::{Person, with_browser};

const ID: &str = include_str!("../../../data/synthetic/practice-01-id.csv");

async fn compare(person: &Person) {
    person.drop_files(&[("practice-01-id.csv", ID)]).await;
    person
        .until("document.querySelectorAll('.log').length === 1")
        .await;
    person.compare("practice-01-id.csv").await;
}

#[test]
fn a_residual_is_seen_as_distribution_and_spectrum_between_states_and_tolerances() {
    with_browser(async |person| {
        compare(person).await;
        for (look, title) in [("distribution", "share per"), ("spectrum", "power density")] {
            person
                .until(&format!(
                    "document.getElementById('{look}').data?.every((trace) => trace.x.length > 1) \
                     && document.getElementById('{look}').layout.yaxis.title.text.startsWith('{title}')"
                ))
                .await;
        }
        person.fill("#spectrum-of", "measured/duty_fill").await;
        person
            .until("document.getElementById('spectrum').layout.yaxis.title.text.includes('%²')")
            .await;

        // The states of the valves are part of the link.
        let shapes = "document.getElementById('time-plots').layout.shapes.filter((shape) => shape.type === 'path').length";
        assert_eq!(person.run(&format!("return {shapes}")).await, 0);
        person.click_in_menu("signals", "[data-states]").await;
        person.until(&format!("{shapes} >= 2")).await;
        let link = person.client.current_url().await.unwrap().to_string();
        assert!(link.contains("states=shown"), "{link}");

        // A tolerance of p_ch: the band is drawn, and the share beyond it is shown.
        let traces = "document.getElementById('time-plots').data.length";
        let before = person.run(&format!("return {traces}")).await;
        let before = before.as_u64().unwrap();
        person.click("#limits summary").await;
        person.fill("[aria-label='p_ch: ± absolute']", "0.05").await;
        person.fill("[aria-label='p_ch: ± time [ms]']", "20").await;
        person.picture("compare-limits").await;
        person.click("#limits button").await;
        person
            .until("document.body.dataset.ready === 'compare' && document.querySelector('[data-band=p_ch] .chip')")
            .await;
        person.until(&format!("{traces} === {}", before + 2)).await;
        let sizes = "const card = document.getElementById('metrics').parentElement; return [card.scrollWidth, card.clientWidth]";
        let sizes: [u32; 2] = serde_json::from_value(person.run(sizes).await).unwrap();
        assert!(sizes[0] <= sizes[1], "the table is cut: {sizes:?}");
        for (look, name) in [
            ("Distribution", "compare-distribution"),
            ("Spectrum", "compare-spectrum"),
        ] {
            let chart = format!("document.querySelector('section[aria-label={look}] .main-svg')");
            person.until(&chart).await;
            person
                .picture_of(&format!("section[aria-label={look}]"), name)
                .await;
        }
        person.picture("compare-closer").await;
        person.click("#theme").await;
        person.picture("compare-closer-other-theme").await;
        person.assert_nothing_was_refused().await;
    });
}

#[test]
fn a_long_list_of_signals_is_filtered() {
    with_browser(async |person| {
        let names: Vec<String> = (0..30)
            .map(|index| format!("temperature_{index}_degC"))
            .collect();
        let row = |time_s: u32| format!("{time_s},0,0,1.5{}\n", ",20".repeat(names.len()));
        let log = format!(
            "time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge,{}\n{}",
            names.join(","),
            (0..200).map(row).collect::<String>()
        );
        person.drop_files(&[("wide.csv", &log)]).await;
        person
            .until("document.querySelectorAll('.log').length === 1")
            .await;
        person.run("[...document.querySelectorAll('.log button')].find((one) => one.textContent.startsWith('Preview')).click()").await;
        let columns = "[...document.querySelectorAll('.mapping .form tbody tr')].filter((row) => !row.hidden).length";
        person.until(&format!("{columns} === 34")).await;
        let type_into = "const field = document.querySelector(arguments[0]); field.value = arguments[1]; field.dispatchEvent(new Event('input'));";
        let typed = |field: &str, text: &str| vec![field.into(), text.into()];
        person
            .run_with(
                type_into,
                typed(".mapping input[type=search]", "temperature_17 DEGC"),
            )
            .await;
        person.until(&format!("{columns} === 1")).await;

        person.click("[data-name=\"wide.csv\"] .compare").await;
        person
            .until("document.querySelectorAll('[data-signal]').length === 33")
            .await;
        person
            .run_with(type_into, typed("[aria-label='filter signals']", "P_CH"))
            .await;
        person.click_in_menu("signals", "#show-found").await;
        person
            .until("document.getElementById('time-plots').layout.annotations.filter((one) => one.xref === 'paper').length <= 2")
            .await;
        let link = person.client.current_url().await.unwrap().to_string();
        assert!(link.contains("temperature_17"), "{link}");
        person.picture("compare-filtered").await;
    });
}

#[test]
fn a_link_hides_the_same_signals_whatever_they_are_called() {
    with_browser(async |person| {
        let log = "time_s,\"a,b [V]\",\"b [V]\",\"100%2C&c=1 [V]\",p_ch_bar_gauge\n0,1,2,3,0\n1,1,2,3,0\n";
        person.drop_files(&[("named.csv", log)]).await;
        person
            .until("document.querySelector('.log .compare')")
            .await;
        person.click(".compare").await;
        person
            .until("document.querySelectorAll('[data-signal]').length === 4")
            .await;
        let shown = "return [...document.querySelectorAll('[data-signal]')].filter((one) => one.checked).map((one) => one.dataset.signal)";
        for name in ["a,b", "100%2C&c=1"] {
            person
                .click_in_menu("signals", &format!("[data-signal='{name}']"))
                .await;
        }
        assert_eq!(person.run(shown).await, json!(["b", "p_ch"]));
        let link = person.client.current_url().await.unwrap().to_string();
        let tab = person.client.new_window(true).await.unwrap();
        person.client.switch_to_window(tab.handle).await.unwrap();
        person.client.goto(&link).await.unwrap();
        person
            .until("document.querySelectorAll('[data-signal]').length === 4")
            .await;
        assert_eq!(person.run(shown).await, json!(["b", "p_ch"]));
    });
}
