//! Back and Forward, the views that pages keep, and jobs that run on while other pages are shown.

use std::time::Duration;

use fantoccini::Client;
use serde_json::{Value, json};

use crate::driver::{Person, with_browser};

/// A fit takes some hundred simulations, in the tests' profile and beside other tests.
const FIT: Duration = Duration::from_secs(300);
const RUNS: &str = "document.querySelector('#jobs:not([hidden]) progress')";

async fn shows(person: &Person, page: &str) {
    let ready = format!("document.body.dataset.ready === '{page}'");
    person.until(&ready).await;
}

async fn go_to(person: &Person, page: &str) {
    person.click(&format!("nav a[href^='#/{page}']")).await;
    shows(person, page).await;
}

/// Returns the range of the time axis of Compare.
async fn range(person: &Person) -> Value {
    let range = "return document.getElementById('time-plots').layout.xaxis.range";
    person.run(range).await
}

async fn back(client: &Client) {
    client.back().await.unwrap();
}

/// Defect seen: Back left the workbench, and a page that was shown again had lost its zoom.
#[test]
fn back_and_forward_move_between_pages_which_keep_their_views() {
    with_browser(async |person| {
        person.open_example().await;
        go_to(person, "compare").await;
        let entries = "return history.length";
        let before = person.run(entries).await;
        let whole = range(person).await;
        for _ in 0..2 {
            person.press("#time-plots", "+").await;
        }
        let zoomed = range(person).await;
        assert_ne!(zoomed, whole);
        assert_eq!(person.run(entries).await, before, "a zoom is no entry");

        // Another log is a view of its own; the page that is shown again is as it was left.
        person.fill("#log", "2").await;
        person
            .until("document.body.dataset.ready === 'compare' && document.getElementById('log').value === '2'")
            .await;
        assert_ne!(range(person).await, zoomed);
        back(&person.client).await;
        person
            .until("document.body.dataset.ready === 'compare' && document.getElementById('log').value === '1'")
            .await;
        assert_eq!(range(person).await, zoomed);
        go_to(person, "refine").await;
        go_to(person, "compare").await;
        assert_eq!(range(person).await, zoomed);

        for page in ["refine", "compare", "logs"] {
            back(&person.client).await;
            shows(person, page).await;
        }
        for page in ["compare", "refine", "compare"] {
            person.client.forward().await.unwrap();
            shows(person, page).await;
        }
        assert_eq!(range(person).await, zoomed);
        person.assert_nothing_was_refused().await;
    });
}

/// Defect seen: a diagnosis of a minute ended when another page was looked at.
#[test]
fn a_job_runs_on_beside_other_pages_until_it_is_complete_or_stopped() {
    with_browser(async |person| {
        person.open_example().await;
        go_to(person, "diagnose").await;
        person.click("#diagnose").await;
        person.until(&format!("{RUNS}?.value > 0")).await;
        // The comparison is a job, too.
        for page in ["compare", "logs", "diagnose"] {
            go_to(person, page).await;
            assert_eq!(
                person.run(&format!("return Boolean({RUNS})")).await,
                json!(true),
                "{page}"
            );
        }
        person.picture_of_window("job-bar").await;
        assert_eq!(
            person
                .run("return document.getElementById('diagnose').hidden")
                .await,
            json!(true)
        );
        person.click("#jobs .cancel").await;
        person
            .until("!document.getElementById('diagnose').hidden && document.getElementById('jobs').hidden")
            .await;

        go_to(person, "refine").await;
        person.fill("#add-effect", "chamber_leak").await;
        person.click("#add").await;
        person
            .until("document.querySelector('[data-key=area_m2]')")
            .await;
        person.click("#fit").await;
        go_to(person, "logs").await;
        person
            .until_within(FIT, "document.getElementById('show-result')")
            .await;
        person.picture_of_window("job-complete").await;
        person.click("#show-result").await;
        shows(person, "refine").await;
        let step = person.text("#steps [aria-current]").await;
        assert!(step.starts_with("fitted chamber leak"), "{step}");
        person.assert_nothing_was_refused().await;
    });
}
