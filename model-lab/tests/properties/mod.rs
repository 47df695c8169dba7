//! Requirement on the path from a file to a comparison for any input, stated once: the fuzz targets and the tests of this crate both test
//! it.

use std::io::Cursor;

use model_lab::{CompareOptions, compare, find_conditions, free_run};
use plant_sim::PlantParameters;
use recording::csv::{self, Mapping, read};
use recording::{Recording, mf4};

/// Log of 119 rows that a mapping may explain.
const LOG: &str = include_str!("../../../recording/tests/corpus/out-of-bounds/log.csv");
/// Largest number of rows: longer logs take longer and show nothing more.
const ROWS_MAX: usize = 1_000;

/// Asserts that any mapping reads a good log and compares it, or is refused.
pub(crate) fn mapping_to_comparison(text: &str) {
    if let Ok(mapping) = Mapping::parse("any.toml", text) {
        let options = csv::Options {
            mapping,
            ..csv::Options::default()
        };
        if let Ok(recording) = read("any.csv", LOG.as_bytes(), &options) {
            compared(&recording);
        }
    }
}

/// Asserts that any bytes that are a CSV log are compared or refused.
pub(crate) fn csv_to_comparison(bytes: &[u8]) {
    if let Ok(recording) = read("any.csv", bytes, &csv::Options::default()) {
        compared(&recording);
    }
}

/// Asserts that any bytes that are an MF4 log are compared or refused.
pub(crate) fn mf4_to_comparison(bytes: &[u8]) {
    let options = mf4::Options {
        limits: mf4::Limits {
            values: 1 << 16,
            unpacked_bytes: 1 << 20,
            ..mf4::Limits::default()
        },
        ..mf4::Options::default()
    };
    if let Ok(recording) = mf4::read("any.mf4", Cursor::new(bytes), &options) {
        compared(&recording);
    }
}

/// Asserts that a log is compared with the nominal plant or refused in one line; every value of a comparison is a number, and the free-run
/// simulation alone gives the same.
pub(crate) fn compared(log: &Recording) {
    if log.time_bases().any(|(_, base)| base.len() > ROWS_MAX) {
        return;
    }
    let defects = log.defects().sentences();
    assert!(
        defects
            .iter()
            .all(|sentence| !sentence.contains(char::is_control))
    );
    let plant = PlantParameters::nominal();
    let free = free_run(&plant, log, &find_conditions(&plant, log));
    let found = match compare(&plant, log, &CompareOptions::default()) {
        Ok(found) => found,
        Err(error) => {
            let text = error.to_string();
            assert!(!text.is_empty() && !text.contains('\n'), "{text}");
            assert!(free.is_err(), "refused, but a free run: {text}");
            return;
        }
    };
    let free = free.expect("what is compared has a free run");
    assert_eq!(free.errors.len(), found.signals.len());
    for (signal, free) in found.signals.iter().zip(&free.errors) {
        let errors = [Some(&signal.free_run), signal.one_step_ahead.as_ref()];
        for error in errors.into_iter().flatten() {
            let figures = [error.rms, error.worst, error.bias, error.worst_time_s];
            assert!(
                figures.iter().all(|figure| figure.is_finite()),
                "{signal:?}"
            );
        }
        assert_eq!(free.rms, Some(signal.free_run.rms), "{}", signal.name);
        assert!(signal.error_map.pressure_bands.len() <= 1000);
    }
    serde_json::to_string(&found).expect("a comparison is JSON");
}
