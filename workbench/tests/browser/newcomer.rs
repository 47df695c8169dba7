//! Actions of a user without the manual: wrong files, double clicks, changes of mind, a server that has ended.

use std::time::Duration;

use serde_json::json;

use crate::driver::{Person, with_browser};

/// A fit takes some hundred simulations, in the tests' profile and beside other tests.
const FIT: Duration = Duration::from_secs(300);
const LOGS: &str = "document.querySelectorAll('.log').length";
const PROBLEMS: &str = "document.querySelectorAll('#messages .problem').length";

async fn go_to(person: &Person, page: &str) {
    person.click(&format!("nav a[href^='#/{page}']")).await;
    person
        .until(&format!("document.body.dataset.ready === '{page}'"))
        .await;
}

#[test]
fn a_picture_is_no_log_and_a_mended_file_can_be_chosen_again() {
    with_browser(async |person| {
        person
            .drop_bytes("bench.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\xff\xfe\0")
            .await;
        person
            .until("document.querySelector('.log.wrong .problem')")
            .await;
        let said = person.text(".log.wrong").await;
        assert!(
            said.contains("bench.png") && said.contains("binary data"),
            "{said}"
        );
        assert!(!person.text("body").await.contains("TypeError"));
        person.run("[...document.querySelectorAll('.log.wrong button')].find((one) => one.textContent === 'Remove').click()").await;
        person.until(&format!("{LOGS} === 0")).await;

        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bench.csv");
        std::fs::write(&file, "time_s,p_ch_bar_gauge\n0,1\n0.01,one\n").unwrap();
        person.choose_file(&file).await;
        person
            .until("document.querySelector('.log.wrong .problem')")
            .await;
        let said = person.text(".log.wrong").await;
        assert!(said.contains("line 3"), "{said}");
        std::fs::write(&file, "time_s,p_ch_bar_gauge\n0,1\n0.01,1\n").unwrap();
        person.choose_file(&file).await;
        person
            .until("document.querySelector('.log:not(.wrong) .compare')")
            .await;
    });
}

#[test]
fn a_problem_is_shown_once_and_goes_with_its_page() {
    with_browser(async |person| {
        let too_big = "#".repeat((1 << 20) + 1);
        for _ in 0..2 {
            person.drop_files(&[("plant.toml", &too_big)]).await;
            person.until(&format!("{PROBLEMS} === 1")).await;
        }
        let said = person.text("#messages").await;
        assert!(said.contains("1 MiB"), "{said}");
        go_to(person, "compare").await;
        assert_eq!(person.run(&format!("return {PROBLEMS}")).await, json!(0));
    });
}

#[test]
fn a_question_can_be_left_unanswered() {
    with_browser(async |person| {
        person.open_example().await;
        let close_everything = "[...document.querySelectorAll('#page button')].find((one) => one.textContent === 'Close everything').click()";
        for opens in [
            "document.querySelector('[data-example=practice-02]').click()",
            close_everything,
        ] {
            person.run(opens).await;
            person.until("document.querySelector('dialog[open]')").await;
            person.run("[...document.querySelectorAll('dialog button')].find((one) => one.textContent === 'Cancel').click()").await;
            person.until("!document.querySelector('dialog')").await;
            assert_eq!(person.run(&format!("return {LOGS}")).await, json!(2));
        }
        person.run(close_everything).await;
        person.until("document.querySelector('dialog[open]')").await;
        person.click("#close").await;
        person.until(&format!("{LOGS} === 0")).await;
    });
}

#[test]
fn a_double_click_begins_and_does_not_cancel() {
    with_browser(async |person| {
        person.open_example().await;
        go_to(person, "refine").await;
        person.fill("#add-effect", "chamber_leak").await;
        person.click("#add").await;
        person
            .until("document.querySelector('[data-key=area_m2]')")
            .await;
        person.double_click("#fit").await;
        person.until_within(FIT, "document.querySelector('#steps [aria-current]').textContent.startsWith('fitted chamber leak')").await;
        assert_eq!(
            person
                .run("return document.querySelectorAll('#steps li').length")
                .await,
            json!(3),
            "opened, added, fitted once"
        );

        go_to(person, "diagnose").await;
        person.double_click("#diagnose").await;
        person
            .until("document.querySelector('.work:not([hidden]) progress')?.value > 0")
            .await;

        // The job goes on while the page is loaded again, and is shown there; it can still be stopped.
        person.client.refresh().await.unwrap();
        person
            .until("document.body.dataset.ready === 'diagnose'")
            .await;
        person
            .until("document.querySelector('#jobs:not([hidden]) progress')?.value > 0")
            .await;
        person.client.refresh().await.unwrap();
        person
            .until("document.querySelector('#jobs:not([hidden]) progress')?.value > 0")
            .await;
        person.click("#jobs .cancel").await;
        person.until("document.getElementById('jobs').hidden").await;
        assert_eq!(
            person
                .run("return sessionStorage.getItem('under-way')")
                .await,
            json!(null)
        );
    });
}

#[test]
fn a_server_that_is_gone_is_reported_on_the_page() {
    with_browser(async |person| {
        person.open_example().await;
        person.stop_the_server();
        person.click("nav a[href^='#/compare']").await;
        person
            .until("document.body.textContent.includes('start `retarder serve` again')")
            .await;
        assert!(!person.text("body").await.contains("TypeError"));
    });
}
