//! Frame times with a long log: 1 kHz in four channels, ten minutes, in a release build an hour.

use std::fmt::Write as _;
use std::time::Instant;

use fantoccini::Locator;

use crate::driver::with_browser;

const ROWS: u32 = if cfg!(debug_assertions) {
    600_000
} else {
    3_600_000
};

/// Returns time series with details at every zoom.
fn log() -> String {
    let mut log = String::from("time_s,p_ch_bar_gauge,i_fill_mA,i_vent_mA,u_bat_V\n");
    for row in 0..ROWS {
        let saw = row % 4000;
        let _ = writeln!(
            log,
            "{}.{:03},{}.{},{},{},24.{}",
            row / 1000,
            row % 1000,
            saw / 800,
            row % 7,
            row % 300,
            row % 211,
            row % 10
        );
    }
    log
}

#[test]
fn a_long_log_opens_and_moves_without_a_visible_stall() {
    with_browser(async |person| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.csv");
        std::fs::write(&path, log()).unwrap();
        let begin = Instant::now();
        let field = person.client.find(Locator::Css("#files")).await.unwrap();
        field.send_keys(path.to_str().unwrap()).await.unwrap();
        person
            .until("document.querySelectorAll('.log').length === 1")
            .await;
        let opened = begin.elapsed();
        // Without commands there is no comparison, but the time series are shown.
        person.click(".compare").await;
        person
            .until("document.getElementById('time-plots')?.data?.length > 0")
            .await;
        person
            .run(
                "window.frames_ms = []; let last = performance.now(); \
                 const frame = (now) => { frames_ms.push(now - last); last = now; requestAnimationFrame(frame); }; requestAnimationFrame(frame); \
                 const chart = document.getElementById('time-plots'); let step = 0; window.moved = false; \
                 const keys = ['+', '+', '+', 'ArrowRight', 'ArrowRight', '+', '+', 'ArrowLeft', '-', '-', 'ArrowRight', '-', '-', '-']; \
                 const next = () => { if (step === keys.length) { window.moved = true; return; } \
                   chart.dispatchEvent(new KeyboardEvent('keydown', { key: keys[step++], bubbles: true })); setTimeout(next, 120); }; next();",
            )
            .await;
        person.until("window.moved").await;
        let frames: Vec<f64> =
            serde_json::from_value(person.run("return frames_ms").await).unwrap();
        let mut sorted = frames.clone();
        sorted.sort_by(f64::total_cmp);
        let of = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
        println!(
            "{ROWS} rows opened in {:.2} s; {} frames while zooming and moving: median {:.1} ms, 95 % {:.1} ms, longest {:.1} ms",
            opened.as_secs_f64(),
            frames.len(),
            of(0.5),
            of(0.95),
            of(1.0)
        );
        // On an idle machine frames are a few times shorter; a page that draws every sample would take seconds on any
        // machine.
        assert!(of(0.5) < 400.0 && of(1.0) < 2500.0, "{sorted:?}");
        let points = person.run("return Math.max(...document.getElementById('time-plots').data.map((trace) => trace.x.length))").await;
        assert!(
            points.as_u64().unwrap() < 6000,
            "{points} points in one trace"
        );
        person.picture("long-log").await;
    });
}
