//! Legends, bars, units of time and the state of buttons on the pages.

use serde_json::json;

use crate::driver::{Person, with_browser};

async fn legend(person: &Person) -> String {
    person.text("#legend").await.replace('\n', " ")
}

#[test]
fn the_legend_lists_what_is_drawn_and_bars_share_a_zero() {
    with_browser(async |person| {
        person.open_example().await;
        person.compare("practice-01-id.csv").await;
        let all = legend(person).await;
        for part in [
            "measured",
            "modelled",
            "rms limit",
            "fill valve",
            "vent valve",
        ] {
            assert!(all.contains(part), "{part}: {all}");
        }
        assert!(!all.contains("tolerance"), "no band is set: {all}");
        person.click_in_menu("signals", "[data-overlay='2']").await;
        person
            .until(
                "document.getElementById('legend').textContent.includes('practice-01-check.csv')",
            )
            .await;
        for signal in ["p_ch", "i_fill", "i_vent"] {
            person
                .click_in_menu("signals", &format!("[data-signal='{signal}']"))
                .await;
        }
        person
            .until("!document.getElementById('legend').textContent.includes('modelled')")
            .await;
        let inputs = legend(person).await;
        assert!(inputs.contains("fill valve"), "{inputs}");

        let zeros = "[...document.querySelectorAll('table')].map((table) => new Set([...table.querySelectorAll('td.share meter')].map((bar) => Math.round(10 * bar.getBoundingClientRect().left))).size)";
        let counts: Vec<u32> =
            serde_json::from_value(person.run(&format!("return {zeros}")).await).unwrap();
        assert!(
            counts.contains(&1) && counts.iter().all(|&zeros| zeros <= 1),
            "{counts:?}"
        );
    });
}

#[test]
fn short_times_are_in_milliseconds() {
    with_browser(async |person| {
        let shown = person
            .client
            .execute_async(
                "const done = arguments[0]; import('/assets/format.js').then(({ duration }) => done([5e-5, 2.5e-4, 0.01, 60].map(duration)));",
                vec![],
            )
            .await
            .unwrap();
        assert_eq!(
            shown,
            json!(["0.0500 ms", "0.250 ms", "10.0 ms", "60.00 s"])
        );
    });
}

/// Goal: less than 150 kB for the first page without the charting library, headers and answers to requests included.
#[test]
fn the_page_without_its_charting_library_is_light() {
    with_browser(async |person| {
        person.open_example().await;
        let sent = "return ['navigation', 'resource'].flatMap((type) => performance.getEntriesByType(type)) \
                    .filter((one) => !one.name.endsWith('/plotly.js')).reduce((sum, one) => sum + one.transferSize, 0)";
        let sent = person.run(sent).await.as_u64().unwrap();
        println!("{sent} bytes without the charting library");
        assert!((10_000..150_000).contains(&sent), "{sent} bytes");
    });
}

/// Every picture for the eyes has a name for a screen reader.
#[test]
fn every_chart_has_a_name_and_terms_have_their_meaning() {
    with_browser(async |person| {
        person.open_example().await;
        person.compare("practice-01-id.csv").await;
        let nameless = "[...document.querySelectorAll('.chart')].filter((chart) => !chart.getAttribute('aria-label') || !chart.getAttribute('role')).map((chart) => chart.id)";
        let charts = "document.querySelectorAll('#time-plots, #error-map, #scatter, #fold, #distribution, #spectrum').length";
        assert_eq!(person.run(&format!("return {nameless}")).await, json!([]));
        assert_eq!(person.run(&format!("return {charts}")).await, json!(6));
        let terms = "return [...new Set([...document.querySelectorAll('abbr')].filter((one) => one.title.length > 20).map((one) => one.textContent))].sort()";
        assert_eq!(
            person.run(terms).await,
            json!(["noise floor", "of the excess"])
        );
    });
}

#[test]
fn a_report_without_logs_cannot_be_written() {
    with_browser(async |person| {
        let disabled = "return document.getElementById('write-report').disabled";
        for (logs, expected) in [(0, true), (2, false)] {
            person.click("nav a[href^='#/report']").await;
            person
                .until("document.body.dataset.ready === 'report'")
                .await;
            assert_eq!(person.run(disabled).await, json!(expected), "{logs} logs");
            person.click("nav a[href^='#/logs']").await;
            person.until("document.body.dataset.ready === 'logs'").await;
            if logs == 0 {
                person.open_example().await;
            }
        }
    });
}

#[test]
fn every_page_ends_in_one_next_step_with_its_button() {
    with_browser(async |person| {
        let next = "(() => { const lines = document.querySelectorAll('.next'); const last = document.getElementById('page').lastElementChild; \
            return lines.length === 1 && last.contains(lines[0]) && lines[0].querySelectorAll('button').length === 1 ? lines[0].textContent : `${lines.length} lines`; })()";
        let empty = person.run(&format!("return {next}")).await;
        assert_eq!(
            empty,
            json!("Next: open a log, or an example.Choose files …")
        );
        person.open_example().await;
        for (page, expected) in [
            (
                "logs",
                "Next: compare practice-01-id.csv with the plant.Compare",
            ),
            (
                "compare",
                "Next: find the physical effect that the model lacks.Diagnose",
            ),
            ("diagnose", "Next: diagnose these logs.Diagnose"),
            (
                "estimate",
                "Next: find the physical effect that the model lacks.Diagnose",
            ),
            (
                "refine",
                "Next: find the physical effect that the model lacks.Diagnose",
            ),
            ("control", "Next: write the report of this session.Report"),
            ("report", "Next: write the report.Write the report"),
        ] {
            person.click(&format!("nav a[href^='#/{page}']")).await;
            person
                .until(&format!("document.body.dataset.ready === '{page}'"))
                .await;
            let shown = person.run(&format!("return {next}")).await;
            assert_eq!(shown, json!(expected), "{page}");
        }
        person.click("#next-step").await;
        person
            .until("document.getElementById('next-step')?.textContent === 'Download report.html'")
            .await;
    });
}
