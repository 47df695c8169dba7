//! A log with several rates: every signal is drawn and compared at its own instants.

use recording::{Provenance, Recording, TimeBase, csv, mf4};

use crate::driver::with_browser;

const ID: &str = include_str!("../../../data/synthetic/practice-01-id.csv");

/// Returns the log with every second sample of the pressure and all of the other signals, as MF4.
fn two_rates() -> Vec<u8> {
    let log = csv::read(
        "practice-01-id.csv",
        ID.as_bytes(),
        &csv::Options::default(),
    )
    .unwrap();
    let (_, all) = log.time_bases().next().unwrap();
    let every_second = |values: &[f64]| -> Vec<f64> { values.iter().copied().step_by(2).collect() };
    let mut rates = Recording::new(Provenance::from_source("rates"));
    let fast = rates.add_time_base(all.clone());
    let slow = rates.add_time_base(TimeBase::new(every_second(all.times_s())).unwrap());
    for signal in log.signals() {
        let values = signal.values_or_nan();
        let (base, values) = match signal.name() {
            "p_ch" => (slow, every_second(values)),
            _ => (fast, values.to_vec()),
        };
        rates
            .add_signal(signal.name(), signal.unit(), base, values)
            .unwrap();
    }
    let mut file = std::io::Cursor::new(Vec::new());
    mf4::write(&mut file, &rates).unwrap();
    file.into_inner()
}

/// Returns the same log as CSV, with empty cells in the other rows.
fn empty_cells() -> String {
    let mut out = String::new();
    let mut rows = 0;
    for line in ID.lines() {
        if line.starts_with('#') || line.starts_with("time") {
            out += line;
        } else {
            let mut cells: Vec<&str> = line.split(',').collect();
            if rows % 2 == 1 {
                cells[3] = "";
            }
            rows += 1;
            out += &cells.join(",");
        }
        out.push('\n');
    }
    out
}

#[test]
fn every_signal_is_drawn_and_compared_at_its_own_instants() {
    assert!(
        ID.lines()
            .any(|line| line.starts_with("time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge"))
    );
    with_browser(async |person| {
        person.drop_bytes("rates.mf4", &two_rates()).await;
        person.drop_files(&[("cells.csv", &empty_cells())]).await;
        person
            .until("document.querySelectorAll('.log').length === 2")
            .await;
        for log in 0..2 {
            let signals = format!(
                "[...document.querySelectorAll('.log')[{log}].querySelectorAll('.signals li')]"
            );
            person.until(&format!("{signals}.some((one) => one.textContent.includes('p_ch') && one.textContent.includes('50.0 Hz'))")).await;
            person
                .until(&format!("{signals}.filter((one) => one.textContent.includes('100 Hz')).length === {signals}.length - 1"))
                .await;
            person
                .until(&format!(
                    "!{signals}.some((one) => one.textContent.includes('missing'))"
                ))
                .await;
        }
        person.picture("logs-of-rates").await;
        for log in ["rates.mf4", "cells.csv"] {
            person.click("nav a[href^='#/logs']").await;
            person
                .until("document.querySelectorAll('.log').length === 2")
                .await;
            person.compare(log).await;
            let titles = "return document.getElementById('time-plots').layout.annotations.map((one) => one.text).join()";
            let titles = person.run(titles).await;
            let titles = titles.as_str().unwrap();
            assert!(
                titles.contains("p_ch [bar gauge], 50.0 Hz")
                    && titles.contains("i_fill [mA], 100 Hz"),
                "{titles}"
            );
            let verdict = person.text("#verdict").await;
            assert!(
                verdict.contains("unexplained") && verdict.contains("p_ch"),
                "{verdict}"
            );
            person.fill("#cursor-a", "20").await;
            person.until("[...document.querySelectorAll('#values tbody tr')].every((row) => row.cells[2].textContent !== '–')").await;
            person
                .click("[data-select='p_ch/valve_state/filling']")
                .await;
            person.until("document.getElementById('time-plots').layout.shapes.some((shape) => shape.type === 'path')").await;
            person
                .until("document.getElementById('scatter').data?.[1]?.x.length > 0")
                .await;
            person
                .until("document.getElementById('spectrum').data?.[0]?.x.length > 0")
                .await;
            person
                .picture(&format!("compare-{}", log.replace('.', "-")))
                .await;
        }
    });
}
