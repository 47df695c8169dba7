//! Places of controls, pop-ups and plots in windows of three sizes.

use serde_json::{Value, json};

use crate::driver::{Person, with_browser};

const SIZES: [(u32, u32); 3] = [(1920, 1080), (1280, 800), (800, 600)];

/// Sets the size of the page, which the window's own bars do not belong to.
pub(crate) async fn set_page_size(person: &Person, (width, height): (u32, u32)) {
    let bars = "return [outerWidth - innerWidth, outerHeight - innerHeight]";
    person.client.set_window_size(width, height).await.unwrap();
    let bars: (u32, u32) = serde_json::from_value(person.run(bars).await).unwrap();
    let window = (width + bars.0, height + bars.1);
    person
        .client
        .set_window_size(window.0, window.1)
        .await
        .unwrap();
    person
        .until(&format!(
            "innerWidth === {width} && innerHeight === {height}"
        ))
        .await;
}

/// Returns the elements that are not inside of the window, with their rectangles.
async fn outside(person: &Person, selector: &str) -> Value {
    person
        .run_with(
            "const { clientWidth, clientHeight } = document.documentElement; \
             const all = [...document.querySelectorAll(arguments[0])]; \
             if (all.length === 0) return 'there is none'; \
             return all.map((one) => [one.textContent.slice(0, 20), one.getBoundingClientRect()]) \
               .filter(([, at]) => at.width === 0 || at.left < 0 || at.top < 0 || at.right > clientWidth || at.bottom > clientHeight);",
            vec![json!(selector)],
        )
        .await
}

#[test]
fn every_pop_up_and_the_header_are_inside_of_windows_of_three_sizes() {
    with_browser(async |person| {
        person.open_example().await;
        for (page, menus) in [
            ("compare", &["signals", "limits", "export"][..]),
            ("control", &["export"]),
        ] {
            person.click(&format!("nav a[href^='#/{page}']")).await;
            person
                .until(&format!("document.body.dataset.ready === '{page}'"))
                .await;
            for size in SIZES {
                set_page_size(person, size).await;
                let cut = outside(person, ".top :is(a:not(.skip), button)").await;
                assert_eq!(cut, json!([]), "header, {page}, {size:?}");
                assert_eq!(
                    person
                        .run("return document.querySelector('.top').offsetHeight < 60")
                        .await,
                    json!(true),
                    "the header has one row, {size:?}"
                );
                for menu in menus {
                    person.click(&format!("#{menu} > summary")).await;
                    let cut = outside(person, &format!("#{menu} > .popup")).await;
                    person
                        .picture_of_window(&format!("{page}-{menu}-{}", size.0))
                        .await;
                    assert_eq!(cut, json!([]), "{menu}, {page}, {size:?}");
                    person.click(&format!("#{menu} > summary")).await;
                }
                assert_eq!(
                    person
                        .run("return document.querySelectorAll('details.menu').length")
                        .await,
                    json!(menus.len()),
                    "every pop-up is tested"
                );
            }
        }
        person.assert_nothing_was_refused().await;
    });
}

/// Names, tops, heights (px) and ends in the window of the rows of the plots.
const ROWS: &str = "const chart = document.getElementById('time-plots'); const top = chart.getBoundingClientRect().top; \
    const full = chart._fullLayout; const axes = Object.keys(full).filter((key) => /^yaxis\\d*$/.test(key)).map((key) => full[key]); \
    return axes.map((one, index) => [full.annotations[index].text, Math.round(one._length), top + one._offset + one._length <= innerHeight && top + one._offset >= 0]);";

async fn rows(person: &Person) -> Vec<(String, f64, bool)> {
    serde_json::from_value(person.run(ROWS).await).unwrap()
}

/// Defect seen: the page had 3583 px, and the pressure, the currents and the time axis were never visible together.
#[test]
fn the_plots_the_time_axis_and_the_error_map_of_compare_fit_a_small_window() {
    with_browser(async |person| {
        set_page_size(person, (1280, 800)).await;
        person.open_example().await;
        person.compare("practice-01-id.csv").await;
        for theme in ["light", "dark"] {
            if person
                .run("return document.documentElement.dataset.theme")
                .await
                != json!(theme)
            {
                person.click("#theme").await;
            }
            person.draw().await;
            person
                .picture_of_window(&format!("compare-screen-{theme}"))
                .await;
            let rows = rows(person).await;
            for name in ["p_ch [", "p_ch: measured", "i_fill [", "i_vent ["] {
                let row = rows.iter().find(|(title, _, _)| title.contains(name));
                let (title, height, is_visible) = row.unwrap();
                assert!(*height >= 34.0 && *is_visible, "{title}: {height} px");
            }
            assert_eq!(outside(person, "#time-plots .xtitle").await, json!([]));
            assert_eq!(outside(person, "#error-map").await, json!([]));
            assert_eq!(person.run("return scrollY").await, json!(0));
        }

        // The marked samples and the cursors are seen beside the row that was clicked.
        person.click("#theme").await;
        person
            .click("[data-select='p_ch/valve_state/both valves shut']")
            .await;
        person.fill("#cursor-a", "16").await;
        person.fill("#cursor-b", "20").await;
        person
            .until("document.getElementById('time-plots').layout.shapes.filter((shape) => shape.type === 'path').length === 1")
            .await;
        person.draw().await;
        person.picture_of_window("page-compare").await;

        // A row is made higher at the expense of the next one.
        let before = rows(person).await;
        person.press(".divider", "ArrowUp").await;
        person.press(".divider", "ArrowUp").await;
        let is_moved = format!(
            "Math.round(document.getElementById('time-plots')._fullLayout.yaxis._length) === {}",
            before[0].1 - 20.0
        );
        person.until(&is_moved).await;
        let after = rows(person).await;
        assert_eq!(after[1].1, before[1].1 + 20.0);
        assert_eq!(after[2..], before[2..]);
        for tab in ["values", "statistics"] {
            person.click(&format!("#tab-{tab}")).await;
            person.draw().await;
            person.picture_of_window(&format!("compare-{tab}")).await;
            let cut = "const panel = document.querySelector('.side'); return panel.scrollWidth > panel.clientWidth";
            assert_eq!(person.run(cut).await, json!(false), "{tab}");
        }
        person.assert_nothing_was_refused().await;
    });
}

#[test]
fn the_time_axis_stays_where_a_log_has_more_signals_than_the_window_has_room() {
    with_browser(async |person| {
        set_page_size(person, (1280, 800)).await;
        let names: Vec<_> = (0..30).map(|one| format!("x{one}_mm")).collect();
        let line = |time: u32| format!("{}{}\n", f64::from(time) / 10.0, ",1".repeat(30));
        let log = format!("time_s,{}\n{}{}", names.join(","), line(0), line(1));
        person.drop_files(&[("many.csv", &log)]).await;
        person
            .until("document.querySelectorAll('.log').length === 1")
            .await;
        person.click(".log .compare").await;
        person.until("document.body.dataset.ready").await;
        person.draw().await;
        person.picture_of_window("compare-many").await;
        let rows = rows(person).await;
        assert!(!rows[29].2 && rows[29].1 >= 34.0, "{:?}", rows[29]);
        assert_eq!(outside(person, ".time-axis .xtitle").await, json!([]));
        person
            .run("document.querySelector('.scroller').scrollTop = 1e6")
            .await;
        assert_eq!(outside(person, ".time-axis .xtitle").await, json!([]));
    });
}
