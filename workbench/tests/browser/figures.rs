//! Speed of the page, printed: figures for `docs/evidence.md`. A release build gives those of an ordinary desktop:
//!
//! `cargo nextest run --release -p workbench --features browser --test browser --no-capture figures:: long_log::`

use std::time::Instant;

use workbench::{Options, Server};

use crate::driver::{with_browser, worker};

const ID: &str = include_str!("../../../data/synthetic/practice-01-id.csv");
const CHECK: &str = include_str!("../../../data/synthetic/practice-01-check.csv");

/// Joins both logs of the rig with a leak into one of 100 s.
fn hundred_seconds() -> String {
    let later = CHECK.lines().skip(1).map(|line| {
        let (time, rest) = line.split_once(',').unwrap();
        format!("{:.2},{rest}\n", time.parse::<f64>().unwrap() + 60.0)
    });
    ID.lines()
        .map(|line| format!("{line}\n"))
        .chain(later)
        .collect()
}

/// Goal: first content within a second of `retarder serve`. The server's part and the browser's part, one after the
/// other.
#[test]
fn first_content() {
    let folder = tempfile::tempdir().unwrap();
    let begin = Instant::now();
    let server = Server::bind(&Options {
        project: folder.path().to_path_buf(),
        port: Some(0),
        worker: worker(),
    });
    let bound_ms = begin.elapsed().as_secs_f64() * 1e3;
    assert!(server.is_ok());
    with_browser(async |person| {
        let paint_ms = person
            .run("return performance.getEntriesByName('first-contentful-paint')[0].startTime")
            .await
            .as_f64()
            .unwrap();
        println!(
            "the server listens after {bound_ms:.0} ms; first content {paint_ms:.0} ms after the address was entered"
        );
        assert!(paint_ms > 0.0);
    });
}

/// Goal: a slider moved on 100 s of log changes the screen within 200 ms.
#[test]
fn a_slider_of_a_hundred_seconds() {
    with_browser(async |person| {
        person
            .drop_files(&[("hundred.csv", &hundred_seconds())])
            .await;
        person
            .until("document.querySelectorAll('.log').length === 1")
            .await;
        person.click("nav a[href^='#/refine']").await;
        person
            .until("document.body.dataset.ready === 'refine'")
            .await;
        person.fill("#add-effect", "chamber_leak").await;
        person.click("#add").await;
        person
            .until("document.querySelector('[data-key=area_m2]')")
            .await;
        let mut screens_ms = Vec::new();
        for place in 1..=20 {
            person
                .run(&format!(
                    "delete document.getElementById('cost').dataset.screen; const slider = document.querySelector('[data-key=area_m2]'); \
                     slider.value = {} * slider.max; slider.dispatchEvent(new Event('input', {{ bubbles: true }}));",
                    0.04 * f64::from(place)
                ))
                .await;
            let screen = "document.getElementById('cost').dataset.screen";
            person.until(screen).await;
            let screen_ms = person.run(&format!("return Number({screen})")).await;
            screens_ms.push(screen_ms.as_f64().unwrap());
        }
        screens_ms.sort_by(f64::total_cmp);
        let text = person.text("#cost").await;
        println!(
            "a slider, 20 places: on the screen after {:.0} ms (median), {:.0} ms at most; last: {text}",
            screens_ms[10], screens_ms[19]
        );
        assert!(text.starts_with("100.0 s of log"), "{text}");
    });
}
