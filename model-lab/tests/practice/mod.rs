//! Logs of the bundled rigs (data/README.md).

use std::path::PathBuf;

use recording::{Provenance, Recording, TimeBase, csv};

pub(crate) fn log(name: &str) -> Recording {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../data/synthetic")
        .join(name);
    csv::read_file(path, &csv::Options::default()).unwrap()
}

/// Returns the first seconds of a log of 100 rows per second, or all of a shorter one.
pub(crate) fn beginning(name: &str, seconds: usize) -> Recording {
    let log = log(name);
    let mut new = Recording::new(Provenance::from_source("beginning"));
    let base = log.time_base(log.signals()[0].time_base()).unwrap();
    let rows = (seconds * 100).min(base.times_s().len());
    let id = new.add_time_base(TimeBase::new(base.times_s()[..rows].to_vec()).unwrap());
    for signal in log.signals() {
        let values = signal.values_or_nan()[..rows].to_vec();
        new.add_signal(signal.name(), signal.unit(), id, values)
            .unwrap();
    }
    new
}
