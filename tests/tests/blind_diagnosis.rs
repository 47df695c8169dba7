//! Small fixed part of the blind benchmark, diagnosed by the library: one development rig of each kind.

use core::ops::ControlFlow;
use std::fs;
use std::path::PathBuf;

use model_lab::diagnosis::diagnose;
use plant_sim::PlantParameters;
use recording::{Recording, csv};
use retarder_tests::blind::draw::{Counts, Draw};
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::score::{Quality, score};

/// Seeds below 100 and this share of the full set are for development.
const SEED: u64 = 2;
const SHARE: f64 = 0.2;

fn quality_of(rig: usize) -> Quality {
    quality_of_part(SEED, rig, usize::MAX)
}

/// Draws one rig, diagnoses the first `rows` of its logs, and scores it.
fn quality_of_part(seed: u64, rig: usize, rows: usize) -> Quality {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders::new(folder.path());
    let (logs, sealed, found) = (folders.logs(), folders.sealed(), folders.found());
    for folder in [&logs, &sealed, found.path()] {
        fs::create_dir(folder).unwrap();
    }
    let drawn = Draw::new(seed, Counts::FULL.share(SHARE)).rig(rig - 1);
    drawn.write(&folders).unwrap();
    let name = &drawn.answer.rig;
    let read = |path: PathBuf| -> [Recording; 1] {
        let whole = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = whole.lines().take(rows).collect();
        fs::write(&path, lines.join("\n")).unwrap();
        [csv::read_file(path, &csv::Options::default()).unwrap()]
    };
    let (id, check) = (read(folders.id_log(name)), read(folders.check_log(name)));
    let watch = |_| ControlFlow::Continue(());
    let diagnosis = diagnose(&PlantParameters::nominal(), &id, &check, &watch).unwrap();
    fs::write(
        found.finding(name),
        serde_json::to_string(&diagnosis).unwrap(),
    )
    .unwrap();
    let report = score(&folders).unwrap();
    assert_eq!((report.rigs.count, report.rigs.of), (1, 1));
    report.quality
}

#[test]
fn a_plain_rig_gets_no_name() {
    let share = quality_of(33).false_names;
    assert_eq!((share.count, share.of), (0, 1));
}

/// Defect seen: the fit of the plain model kept an old Jacobian and did not converge; a lag of 50 µs was named.
#[test]
fn a_plain_rig_with_a_long_way_to_its_fit_gets_no_name() {
    let share = quality_of_part(3, 32, usize::MAX).false_names;
    assert_eq!((share.count, share.of), (0, 1));
}

#[test]
fn a_clamp_is_named() {
    let quality = quality_of(56);
    let (right, wrong) = (quality.right_names, quality.wrong_names);
    assert_eq!((right.count, right.of, wrong.count), (1, 1, 0));
}

/// Defect seen: a lag and a dead volume were named.
#[test]
fn a_lag_of_another_law_is_named() {
    let quality = quality_of(54);
    let (right, wrong) = (quality.right_names, quality.wrong_names);
    assert_eq!((right.count, right.of, wrong.count), (1, 1, 0));
}

/// Defect seen: only the warm coil was named.
#[test]
fn warm_gas_and_a_warm_coil_are_both_named() {
    let quality = quality_of(31);
    let (both, wrong) = (quality.both_of_two, quality.wrong_names);
    assert_eq!((both.count, both.of, wrong.count), (1, 1, 0));
}

/// Defect seen: a plunger with an undetermined volume was named. Half a minute of each log, since it tries every pair.
#[test]
fn a_bowed_sensor_gets_no_name() {
    let share = quality_of_part(SEED, 59, 3000).named_outside;
    assert_eq!((share.count, share.of), (0, 1));
}

#[test]
fn warm_coils_are_named_after_a_short_log() {
    let quality = quality_of(62);
    let (right, wrong) = (quality.right_names, quality.wrong_names);
    assert_eq!((right.count, right.of, wrong.count), (1, 1, 0));
}
