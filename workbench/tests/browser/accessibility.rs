//! Accessibility of every page by axe-core: names, roles, keyboard and contrast, WCAG 2.1 A and AA, in both themes.

use std::path::Path;

use serde_json::{Value, json};

use crate::driver::{Person, with_browser};
use crate::refine::DIAGNOSIS;

/// Pages in the order of the work.
const PAGES: [&str; 7] = [
    "logs", "compare", "estimate", "diagnose", "refine", "control", "report",
];

/// Returns axe-core, which `cargo xtask setup` fetches into the target folder.
fn axe() -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("axe-core/axe.min.js");
    std::fs::read_to_string(&path).unwrap_or_else(|error| {
        panic!(
            "axe-core is missing, {}: {error}; run `cargo xtask setup`",
            path.display()
        )
    })
}

/// Returns the violations on the page, each with its rule and its elements.
async fn violations(person: &Person, axe: &str) -> Vec<String> {
    let is_there = person.run("return Boolean(window.axe)").await;
    if is_there == json!(false) {
        person.run(axe).await;
    }
    let found = person
        .client
        .execute_async(
            "const done = arguments[0]; \
             const tags = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa']; \
             axe.run(document, { runOnly: { type: 'tag', values: tags } }).then(({ passes, violations }) => done([passes.length, \
               violations.flatMap((rule) => rule.nodes.map((node) => `${rule.id}: ${node.target.join(' ')}: ${node.failureSummary}`))]));",
            vec![],
        )
        .await
        .unwrap();
    let (passes, found): (usize, Vec<String>) = serde_json::from_value(found).unwrap();
    assert!(passes > 5, "axe-core checked the page");
    found
}

/// Checks the page as it is shown, and that each of its charts has a name.
pub(crate) async fn assert_accessible(person: &Person) {
    let found = violations(person, &axe()).await;
    assert!(found.is_empty(), "{}", found.join("\n"));
    let nameless = "return [...document.querySelectorAll('.chart')] \
        .filter((chart) => !chart.getAttribute('aria-label') || !chart.getAttribute('role')).map((chart) => chart.id)";
    assert_eq!(
        person.run(nameless).await,
        json!([]),
        "charts without a name"
    );
}

async fn go_to(person: &Person, page: &str) {
    person.click(&format!("nav a[href^='#/{page}']")).await;
    person
        .until(&format!("document.body.dataset.ready === '{page}'"))
        .await;
}

/// Calls `check` with each pop-up of the page open.
async fn each_pop_up(person: &Person, check: impl AsyncFn(&Person)) {
    let count = "return document.querySelectorAll('details.menu').length";
    let count = person.run(count).await.as_u64().unwrap();
    for menu in 0..count {
        let turn = "document.querySelectorAll('details.menu')[arguments[0]].open = arguments[1]";
        person.run_with(turn, vec![json!(menu), json!(true)]).await;
        check(person).await;
        person.run_with(turn, vec![json!(menu), json!(false)]).await;
    }
}

/// Calls `check` on each page in both themes, with everything unfolded.
async fn on_all_pages(person: &Person, check: impl AsyncFn(&Person)) {
    for page in PAGES {
        go_to(person, page).await;
        // What is folded is not checked; pop-ups lie above the page and are opened alone.
        person
            .run("for (const one of document.querySelectorAll('details:not(.menu)')) one.open = true")
            .await;
        for _ in 0..2 {
            person.click("#theme").await;
            person.draw().await;
            check(person).await;
            each_pop_up(person, &check).await;
        }
    }
}

#[test]
fn no_page_violates_wcag_2_1_aa_in_light_or_dark() {
    with_browser(async |person| {
        person.open_example().await;
        // Pages with results have more to check: an estimation, an effect with its sliders.
        go_to(person, "estimate").await;
        person.click("#estimate").await;
        person
            .until_within(
                DIAGNOSIS,
                "document.querySelector('#correlation-plot .main-svg')",
            )
            .await;
        go_to(person, "refine").await;
        person.fill("#add-effect", "chamber_leak").await;
        person.click("#add").await;
        person
            .until("document.querySelector('[data-key=area_m2]')")
            .await;
        on_all_pages(person, assert_accessible).await;
    });
}

/// The check itself can fail: a button without a name and a pale text are found.
#[test]
fn a_nameless_button_and_a_pale_text_are_found() {
    let axe = axe();
    with_browser(async |person| {
        person
            .run(
                "const page = document.getElementById('page'); page.append(document.createElement('button')); \
                 const pale = document.createElement('p'); pale.textContent = 'pale'; \
                 pale.style.color = '#d0d0d0'; pale.style.background = '#ffffff'; page.append(pale);",
            )
            .await;
        let found = violations(person, &axe).await;
        for rule in ["button-name", "color-contrast"] {
            assert!(
                found.iter().any(|one| one.starts_with(rule)),
                "{rule}: {found:?}"
            );
        }
    });
}

/// The loop works by the keyboard alone: from the example to the requirements with keys of the keyboard only.
#[test]
fn the_loop_is_closed_by_the_keyboard_alone() {
    with_browser(async |person| {
        press_on(person, "[data-example='practice-01']").await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;
        for page in ["compare", "estimate", "diagnose", "refine"] {
            press_on(person, &format!("nav a[href^='#/{page}']")).await;
            person
                .until(&format!("document.body.dataset.ready === '{page}'"))
                .await;
        }
        press_on(person, "#add").await;
        person.until("document.querySelector('.effect')").await;
        press_on(person, "nav a[href^='#/control']").await;
        person
            .until("document.body.dataset.ready === 'control' && document.querySelector('#requirements tbody tr')")
            .await;
    });
}

/// Moves the focus by Tab to an element, and presses Enter there.
async fn press_on(person: &Person, selector: &str) {
    const TAB: &str = "\u{e004}";
    const ENTER: &str = "\u{e007}";
    let is_focused = "return document.activeElement === document.querySelector(arguments[0])";
    for _ in 0..400 {
        if person.run_with(is_focused, vec![json!(selector)]).await == Value::Bool(true) {
            person.type_key(ENTER).await;
            return;
        }
        person.type_key(TAB).await;
    }
    panic!("{selector} is not reached by Tab");
}
