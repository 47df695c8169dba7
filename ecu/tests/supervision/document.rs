//! Comparison of `docs/safety.md` with the code.

use std::collections::BTreeMap;

use ecu::{Fault, FaultReaction, Mechanism};

use crate::page::{assert_written, with_table};

const PAGE: &str = include_str!("../../../docs/safety.md");

/// Returns the rows of the table with these columns: the first cell without quotes, and the others.
fn rows(columns: &str) -> BTreeMap<&'static str, Vec<&'static str>> {
    let (_, table) = PAGE
        .split_once(columns)
        .unwrap_or_else(|| panic!("no table {columns}"));
    let mut rows = BTreeMap::new();
    for line in table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'))
    {
        let cells: Vec<&str> = line
            .trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().trim_matches('`'))
            .collect();
        let (name, others) = cells.split_first().unwrap();
        assert!(
            rows.insert(*name, others.to_vec()).is_none(),
            "{name} twice"
        );
    }
    rows
}

/// `BLESS=1 cargo nextest run -p retarder-ecu faults_of_the_page` writes the table.
#[test]
fn the_faults_of_the_page_are_those_of_the_code() {
    let rows = Fault::ALL.map(|fault| {
        format!(
            "| `{fault:?}` | {} | {} | `{:?}` | {} |",
            fault.rule(),
            fault.samples(),
            fault.reaction(),
            fault.why()
        )
    });
    let header = "| fault | rule | N | reaction | why this reaction |";
    assert_written("safety.md", PAGE, &with_table(PAGE, header, &rows));
}

#[test]
fn each_way_is_on_the_page_the_stricter_the_later() {
    let (_, table) = PAGE.split_once("| reaction | what happens |").unwrap();
    let places = [
        FaultReaction::Hold,
        FaultReaction::Ramp,
        FaultReaction::Release,
        FaultReaction::Vent,
        FaultReaction::Off,
        FaultReaction::Lock,
    ]
    .map(|reaction| {
        table
            .find(&format!("\n| `{reaction:?}` |"))
            .unwrap_or_else(|| panic!("no {reaction:?}"))
    });
    assert!(places.is_sorted(), "{places:?}");
    assert_eq!(
        rows("| reaction | what happens | how long | when |").len(),
        places.len()
    );
}

#[test]
fn each_mechanism_is_on_the_page() {
    let rows = rows("| mechanism | without it |");
    for mechanism in Mechanism::ALL {
        assert!(
            rows.contains_key(format!("{mechanism:?}").as_str()),
            "{mechanism:?}"
        );
    }
    assert_eq!(rows.len(), Mechanism::ALL.len());
}

/// Flow through equal orifices with the discharge of the nominal plant: choked to ambient, subsonic from the supply.
#[test]
fn a_fill_valve_stuck_open_leaves_the_pressure_that_the_page_says() {
    let (supply_abs, ambient) = (8.4 + 1.013, 1.013);
    let critical: f64 = 0.528;
    let surplus = |chamber_abs: f64| {
        let over = ((chamber_abs / supply_abs - critical) / (1.0 - critical)).max(0.0);
        0.95 * supply_abs * (1.0 - over * over).sqrt() - 0.97 * chamber_abs
    };
    let (mut low, mut high) = (ambient, supply_abs);
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        if surplus(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    let sentence = format!("stays at {:.1} bar of a supply of 8.4 bar", low - ambient);
    assert!(PAGE.contains(&sentence), "{sentence}");
}

/// Tests and files that the page names exist.
#[test]
fn what_the_page_points_at_exists() {
    let tests = concat!(
        include_str!("detection.rs"),
        include_str!("document.rs"),
        include_str!("../../../hil-harness/tests/false_alarms.rs"),
    );
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let mut files = 0;
    for quoted in PAGE.split('`').skip(1).step_by(2) {
        if quoted.ends_with(".rs") || quoted.ends_with('/') {
            assert!(std::path::Path::new(root).join(quoted).exists(), "{quoted}");
            files += 1;
        } else if quoted.matches('_').count() > 4 {
            assert!(tests.contains(&format!("fn {quoted}()")), "{quoted}");
        }
    }
    assert!(files > 6);
}
