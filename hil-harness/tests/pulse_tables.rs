//! The tables of the model-based pulses in the controller are those of the nominal plants.

use std::path::Path;
use std::{env, fs};

use hil_harness::pulse_table::{SHIPPED, flow_source, source};

/// Compares a checked-in file with its text, or writes it if `BLESS` is set.
fn check(file: &str, text: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../controller/src/pulses/tables");
    let path = folder.join(file);
    if env::var_os("BLESS").is_some() {
        fs::write(&path, text).expect("the table is writable");
    }
    let found = fs::read_to_string(&path).expect("the table is checked in");
    assert!(
        found == text,
        "{file} is not the table of its plant: bless it, see the head of the file"
    );
}

/// Goal: no table that nobody can make again. Method: simulate every pulse anew, and compare the text.
#[test]
fn the_checked_in_pulse_tables_are_those_of_the_nominal_plants() {
    for shipped in &SHIPPED {
        check(&format!("{}.rs", shipped.name), &source(shipped));
    }
    check("flow.rs", &flow_source(&SHIPPED[0].plant()));
}
