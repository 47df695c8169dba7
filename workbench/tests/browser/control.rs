//! The loop is closed, examined, changed, refused, run on scattered rigs, and written into a report.

use serde_json::json;

use crate::driver::{Person, with_browser};

const NOMINAL: &str = include_str!("../../../data/nominal-plant.toml");
const LEAK: &str = "\n[effects.chamber_leak]\nvariant = \"orifice\"\narea_m2 = 2e-8\n";
const ID: &str = include_str!("../../../data/synthetic/practice-01-id.csv");

/// Goes to a page by its tab, and waits until it is shown.
async fn go(person: &Person, page: &str) {
    person.click(&format!("nav a[href^='#/{page}']")).await;
    person
        .until(&format!("document.body.dataset.ready === '{page}'"))
        .await;
}

async fn open_leaky_plant(person: &Person) {
    let toml = format!("{NOMINAL}{LEAK}");
    person.drop_files(&[("leaky.toml", &toml)]).await;
    person
        .until("document.querySelector('#plant-title')?.parentElement.textContent.includes('leaky.toml')")
        .await;
}

#[test]
fn the_loop_is_run_on_both_plants_changed_and_spread_over_rigs() {
    with_browser(async |person| {
        open_leaky_plant(person).await;
        go(person, "control").await;
        let verdict = person.text("#control-verdict").await;
        assert!(
            verdict.contains("plain: ") && verdict.contains("refined: "),
            "{verdict}"
        );
        // Reference with its two edges, then two runs in each of seven plots.
        person
            .until("document.getElementById('run-plots').data.length === 3 + 2 * 7")
            .await;
        let rows = person
            .run("return document.querySelectorAll('#requirements tbody tr').length")
            .await;
        assert!(rows.as_u64().unwrap() >= 6, "{rows}");
        person.picture("control").await;

        // All plots have one time axis: keys move all of them, and the address contains the range.
        person.press("#run-plots", "+").await;
        person.press("#run-plots", "+").await;
        person
            .until("new URLSearchParams(location.hash.split('?')[1]).has('from')")
            .await;
        person
            .until("document.getElementById('run-plots').layout.xaxis.range[0] > 3")
            .await;
        person.picture("control-zoomed").await;
        person.press("#run-plots", "Home").await;

        // Another controller; a wrong value is refused beside its field, with the message of the controller file's
        // reader.
        person.click("#thesis-controller").await;
        person
            .until("document.getElementById('controller-name').textContent === 'thesis controller' && document.body.dataset.ready === 'control'")
            .await;
        person
            .fill("[data-setting='pid.gain_pct_per_bar'] input", "4000")
            .await;
        person.click("#apply-controller").await;
        person
            .until(
                "document.querySelector('#controller .problem').textContent.includes('1000 %/bar')",
            )
            .await;
        person
            .until("document.querySelector('[data-setting=\"pid.gain_pct_per_bar\"] input').classList.contains('wrong')")
            .await;
        person.picture("control-refused").await;
        person
            .fill("[data-setting='pid.gain_pct_per_bar'] input", "30")
            .await;
        person.click("#apply-controller").await;
        person
            .until("document.getElementById('controller-name').textContent === 'thesis controller, changed' && document.body.dataset.ready === 'control'")
            .await;

        // A profile of the user.
        person
            .run("document.querySelectorAll('.profile-step .close').forEach((one) => one.click())")
            .await;
        person.click("#add-step").await;
        person
            .fill(".profile-step input[aria-label^='time']", "0.5")
            .await;
        person
            .fill(".profile-step input[aria-label^='reference']", "4")
            .await;
        person.fill("[aria-label='end of the profile']", "2").await;
        person.click("#apply-profile").await;
        person
            .until("document.getElementById('profile').textContent.includes('figure-6.5, edited') && document.body.dataset.ready === 'control'")
            .await;
        person
            .until("document.getElementById('run-plots').layout.xaxis.range[1] < 2.1")
            .await;

        // A batch is stopped, and another one runs to its end.
        person.fill("#rigs", "1000").await;
        person.click("#run-batch").await;
        person.until("document.getElementById('stop-batch')").await;
        person.click("#stop-batch").await;
        person
            .until("document.getElementById('batch-status').textContent === 'stopped'")
            .await;
        person.fill("#rigs", "12").await;
        person.click("#run-batch").await;
        person
            .until("document.getElementById('settling').data?.length === 4")
            .await;
        let status = person.text("#batch-status").await;
        assert!(status.contains("of 12 rigs pass"), "{status}");
        person.picture("control-batch").await;
        person.click("#theme").await;
        person
            .until("document.documentElement.dataset.theme === 'dark'")
            .await;
        person.picture("control-dark").await;
        person.assert_nothing_was_refused().await;
    });
}

#[test]
fn the_report_is_written_shown_and_downloaded() {
    with_browser(async |person| {
        person
            .drop_files(&[
                ("practice-01-id.csv", ID),
                ("<b>broken.csv", "time_s,p_ch_bar_gauge\n0,1\n0,2\n"),
            ])
            .await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;
        go(person, "control").await;
        go(person, "report").await;
        person.click("#write-report").await;
        person
            .until("document.getElementById('preview')?.dataset.loaded === 'yes'")
            .await;
        // The frame has no origin, so this page cannot read it; the browser can.
        let frame = person
            .client
            .find(fantoccini::Locator::Css("#preview"))
            .await
            .unwrap();
        frame.enter_frame().await.unwrap();
        let text = person.text("body").await;
        for part in [
            "practice-01-id.csv",
            "<b>broken.csv",
            "Model compared with measurement",
            "Control loop",
            "recommended controller",
        ] {
            assert!(text.contains(part), "{part} is missing");
        }
        person.client.clone().enter_parent_frame().await.unwrap();
        person.picture("report").await;
        person.click("#theme").await;
        person.picture("report-dark").await;
        let file = person
            .run("const link = document.getElementById('download-report'); return [link.hidden, link.download, link.pathname.endsWith('/report/file')]")
            .await;
        assert_eq!(file, json!([false, "report.html", true]));
        person.assert_nothing_was_refused().await;
    });
}
