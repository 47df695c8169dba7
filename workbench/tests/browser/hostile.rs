//! Hostile log.

use serde_json::json;

use crate::driver::with_browser;

const NAMES: [&str; 10] = [
    "\"><img src=x onerror=alert(1)>",
    "</script><script>alert(1)</script>",
    "<svg/onload=alert(1)>",
    "<b>bold</b>",
    "<a href=\"javascript:alert(1)\">x</a>",
    "{{constructor.constructor('alert(1)')()}}",
    "%{x}<br>%{customdata}",
    "$\\href{javascript:alert(1)}{x}$",
    "__proto__",
    "&lt;img src=x onerror=alert(1)&gt;",
];

/// Names of signals and files are text on every page and in every label of a chart.
#[test]
fn names_of_a_log_are_text_wherever_they_are_shown() {
    with_browser(async |person| {
        let columns: String = NAMES
            .iter()
            .map(|name| format!(",\"{} [V]\"", name.replace('"', "\"\"")))
            .collect();
        let zeros = ",1".repeat(NAMES.len());
        let head = format!("time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge{columns}\n");
        let rows = (0..200).map(|row| {
            format!(
                "{},{},0,{}{zeros}\n",
                f64::from(row) * 0.01,
                50 * (row / 50 % 2),
                f64::from(row) * 0.001
            )
        });
        let log = head + &rows.collect::<String>();
        let name = "<img src=x onerror=alert(1)>.csv";
        person.drop_files(&[(name, &log)]).await;
        person
            .until("document.querySelectorAll('.log').length === 1")
            .await;
        let page = person.text("main").await;
        assert!(page.contains(name), "{page}");
        for name in NAMES {
            assert!(page.contains(name), "{name} is not shown as it is: {page}");
        }
        person.run("[...document.querySelectorAll('.log button')].find((one) => one.textContent.startsWith('Preview')).click()").await;
        person.until("document.querySelector('.raw')").await;
        person.picture("hostile-logs").await;
        person.click(".compare").await;
        person
            .until("document.body.dataset.ready === 'compare'")
            .await;
        for name in NAMES {
            person.run_with(
                "const choice = document.getElementById('scatter-over'); choice.value = arguments[0]; choice.dispatchEvent(new Event('change', { bubbles: true }));",
                vec![json!(name)],
            )
            .await;
        }
        person
            .until("document.getElementById('scatter').textContent.includes('img src=x')")
            .await;
        person.picture("hostile-compare").await;
        let titles = person.text("#time-plots").await;
        assert!(!titles.contains("[object"), "{titles}");
        let grown = person.run("return document.querySelectorAll('main img, main script, main a[href^=javascript], body [onerror]').length").await;
        assert_eq!(grown, json!(0));
        assert!(
            person.client.get_alert_text().await.is_err(),
            "a dialogue is open"
        );
        person.assert_nothing_was_refused().await;
    });
}
