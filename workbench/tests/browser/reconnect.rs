//! A server that ends and is started again under an open tab.

use serde_json::json;

use crate::driver::{Person, with_browser};

const NOTICE: &str = "document.querySelector('#connection:not([hidden])')";

/// Pastes a text into the field for the new address.
async fn paste(person: &Person, text: &str) {
    person
        .run_with(
            "const field = document.getElementById('new-address'); field.value = arguments[0]; \
             field.dispatchEvent(new InputEvent('input', { bubbles: true }));",
            vec![json!(text)],
        )
        .await;
}

/// Defect seen: a server that ended within an answer was reported as "Failed to fetch" beside the notice.
#[test]
fn an_answer_that_is_cut_off_counts_as_no_answer() {
    with_browser(async |person| {
        person.open_example().await;
        person.compare("practice-01-id.csv").await;
        person
            .run(
                "globalThis.fetch = async (path) => { \
                   if (path.endsWith('/presence')) throw new TypeError('Failed to fetch'); \
                   return new Response(new ReadableStream({ start: (body) => body.error(new TypeError('Failed to fetch')) })); }",
            )
            .await;
        person.press("#time-plots", "+").await;
        person.until(NOTICE).await;
        assert_eq!(
            person
                .run("return document.querySelectorAll('#messages .problem').length")
                .await,
            json!(0)
        );
    });
}

/// Defect seen: after a restart of the server, an open tab was dead and did not say so.
#[test]
fn an_open_tab_says_that_its_server_has_ended_and_continues_with_the_new_address() {
    with_browser(async |person| {
        person.open_example().await;
        person.compare("practice-01-id.csv").await;
        person.press("#time-plots", "+").await;
        let range = "document.getElementById('time-plots').layout.xaxis.range.join()";
        let seen = person.run(&format!("return {range}")).await;

        // Nobody does anything on the page.
        person.stop_the_server();
        person.until(NOTICE).await;
        let words = person.text("#connection").await;
        assert!(words.contains("start `retarder serve` again"), "{words}");
        let address = person.start_another_server().await;
        person
            .until(
                "document.getElementById('connection').textContent.includes('was started again')",
            )
            .await;
        person.picture_of_window("reconnect").await;
        // Charts whose request failed do not repeat what the notice says.
        assert_eq!(
            person
                .run("return document.querySelectorAll('#messages .problem').length")
                .await,
            json!(0)
        );

        paste(person, &person.address).await;
        person
            .until("document.querySelector('#connection .problem').textContent.includes('not the address of the running server')")
            .await;
        paste(person, &address).await;
        person.until(&format!("!{NOTICE}")).await;
        person
            .until("document.body.dataset.ready === 'compare'")
            .await;
        assert_eq!(person.run(&format!("return {range}")).await, seen);
        assert_eq!(
            person
                .run("return document.getElementById('log').length")
                .await,
            json!(2)
        );

        // The token alone is enough.
        person.stop_the_server();
        person.until(NOTICE).await;
        let address = person.start_another_server().await;
        person
            .until(
                "document.getElementById('connection').textContent.includes('was started again')",
            )
            .await;
        paste(person, address.rsplit_once('=').unwrap().1).await;
        person.until(&format!("!{NOTICE}")).await;
        person.assert_nothing_was_refused().await;
    });
}

/// A page loads its modules when it is first shown: one that was opened while the server was gone is shown after the restart.
#[test]
fn a_page_that_was_first_opened_without_a_server_is_shown_after_the_restart() {
    with_browser(async |person| {
        person.open_example().await;
        person.stop_the_server();
        person.click("nav a[href^='#/refine']").await;
        person.until(NOTICE).await;
        person
            .until("document.getElementById('page').textContent.includes('start `retarder serve` again')")
            .await;
        let address = person.start_another_server().await;
        person
            .until(
                "document.getElementById('connection').textContent.includes('was started again')",
            )
            .await;
        paste(person, &address).await;
        person
            .until("document.body.dataset.ready === 'refine'")
            .await;
    });
}
