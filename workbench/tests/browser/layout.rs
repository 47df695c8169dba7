//! Places of controls and pop-ups in windows of three sizes.

use serde_json::{Value, json};

use crate::driver::{Person, with_browser};

const SIZES: [(u32, u32); 3] = [(1920, 1080), (1280, 800), (800, 600)];

/// Sets the size of the page, which the window's own bars do not belong to.
async fn set_page_size(person: &Person, (width, height): (u32, u32)) {
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
        person.click("[data-example='practice-01']").await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;
        for (page, menus) in [
            ("compare", &["limits", "export"][..]),
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
                    person.draw().await;
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
