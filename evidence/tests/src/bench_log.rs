//! Bundled bench logs.

use std::path::{Path, PathBuf};

use plant_sim::PlantParameters;
use plant_sim::replay::{self, ReplayInput};
use recording::{Recording, csv};

/// Returns the repository's root.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("the crate is in `evidence/` of the repository")
        .to_owned()
}

/// Reads a bundled synthetic log, by name without extension.
pub fn synthetic(name: &str) -> Recording {
    let path = repository().join(format!("data/synthetic/{name}.csv"));
    csv::read_file(&path, &csv::Options::default()).expect("a bundled log is read")
}

/// Returns the commands of a bundled synthetic log.
pub fn commands(name: &str) -> Vec<ReplayInput> {
    let log = synthetic(name);
    let inputs = replay::inputs(&PlantParameters::nominal(), &log);
    inputs.expect("a bundled log has commands").1
}
