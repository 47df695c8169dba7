//! Two tabs, and a page that is opened again.

use fantoccini::Locator;

use crate::driver::with_browser;

#[test]
fn two_tabs_do_not_meet_and_a_reloaded_one_has_its_project() {
    with_browser(async |person| {
        let log = "time_s,p_ch_bar_gauge\n0,1\n1,2\n";
        person.drop_files(&[("first-tab.csv", log)]).await;
        person
            .until("document.querySelectorAll('.log').length === 1")
            .await;
        let first = person.client.window().await.unwrap();
        let other = person.client.new_window(true).await.unwrap();
        person
            .client
            .switch_to_window(other.handle.clone())
            .await
            .unwrap();
        let page = person.address.split('?').next().unwrap().to_owned();
        person.client.goto(&page).await.unwrap();
        person.until("document.body.dataset.ready === 'logs'").await;
        // A new tab begins with a copy of the project that was open last.
        person
            .until("document.querySelectorAll('.log').length === 1")
            .await;
        person
            .until("document.getElementById('messages').textContent.includes('This tab works on a copy')")
            .await;
        person.drop_files(&[("second-tab.csv", log)]).await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;

        person.client.switch_to_window(first).await.unwrap();
        person.client.refresh().await.unwrap();
        person.until("document.body.dataset.ready === 'logs'").await;
        let names = person
            .client
            .find_all(Locator::Css(".log h2"))
            .await
            .unwrap();
        assert_eq!(names.len(), 1);
        assert_eq!(names[0].text().await.unwrap(), "first-tab.csv");
    });
}
