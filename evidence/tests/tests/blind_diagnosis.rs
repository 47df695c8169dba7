//! Small fixed part of the blind benchmark, diagnosed by the library: one development rig of each kind.

mod other_kinds;

use core::ops::ControlFlow;
use std::fs;
use std::path::PathBuf;

use model_lab::diagnosis::diagnose;
use model_lab::diagnosis::result::{Diagnosis, Verdict};
use plant_sim::PlantParameters;
use recording::{Recording, csv};
use retarder_tests::blind::draw::KnownRig;
use retarder_tests::blind::format::{Class, Folders, Poor};
use retarder_tests::blind::score::{Quality, score};

/// Effect, law, size over the typical one, and shape.
type Hidden = (&'static str, &'static str, f64, f64);

/// Plain rigs of development seeds, by their numbers.
const fn plain(seed: u64, number: usize) -> KnownRig {
    KnownRig {
        seed,
        number,
        class: Class::Plain,
        poor: None,
        hidden: &[],
    }
}

/// Rig of seed 2 with these hidden effects.
const fn hiding(number: usize, class: Class, hidden: &'static [Hidden]) -> KnownRig {
    KnownRig {
        class,
        hidden,
        ..plain(2, number)
    }
}

const fn warm_coils(size_over_typical: f64, shape: f64) -> Hidden {
    (
        "coil_ambient_temperature",
        "both coils in warm surroundings",
        size_over_typical,
        shape,
    )
}

fn quality_of(rig: KnownRig) -> Quality {
    quality_of_part(rig, usize::MAX)
}

fn quality_of_part(rig: KnownRig, rows: usize) -> Quality {
    diagnosed(rig, rows).1
}

/// Asserts that the hidden effect of a rig is named, and nothing else.
fn assert_named_alone(rig: KnownRig) {
    let Quality {
        right_names: right,
        wrong_names: wrong,
        ..
    } = quality_of(rig);
    assert_eq!((right.count, right.of, wrong.count), (1, 1, 0));
}

/// Runs a rig, diagnoses the first `rows` of its logs, and scores it.
fn diagnosed(rig: KnownRig, rows: usize) -> (Diagnosis, Quality) {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders::new(folder.path());
    let (logs, sealed, found) = (folders.logs(), folders.sealed(), folders.found());
    for folder in [&logs, &sealed, found.path()] {
        fs::create_dir(folder).unwrap();
    }
    let drawn = rig.run();
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
    (diagnosis, report.quality)
}

#[test]
fn a_plain_rig_gets_no_name() {
    let share = quality_of(plain(2, 33)).false_names;
    assert_eq!((share.count, share.of), (0, 1));
}

/// Defect seen: the fit of the plain model kept an old Jacobian and did not converge; a lag of 50 µs was named.
#[test]
fn a_plain_rig_with_a_long_way_to_its_fit_gets_no_name() {
    let share = quality_of(plain(3, 32)).false_names;
    assert_eq!((share.count, share.of), (0, 1));
}

#[test]
fn a_clamp_is_named() {
    const CLAMP: Hidden = ("flyback_clamp", "constant voltage", 4.618, 0.247);
    assert_named_alone(hiding(56, Class::Matched, &[CLAMP]));
}

/// Defect seen: a lag and a dead volume were named.
#[test]
fn a_lag_of_another_law_is_named() {
    const LAG: Hidden = ("sensor_lag", "two lags", 7.281, 0.656);
    assert_named_alone(hiding(54, Class::Variant, &[LAG]));
}

/// Defect seen: only the warm coil was named.
#[test]
fn warm_gas_and_a_warm_coil_are_both_named() {
    const GAS: Hidden = (
        "gas_temperature",
        "constant heat transfer to a cold wall",
        4.317,
        0.890,
    );
    const WARM: Hidden = warm_coils(4.304, 0.626);
    let quality = quality_of(hiding(31, Class::Two, &[GAS, WARM]));
    let (both, wrong) = (quality.both_of_two, quality.wrong_names);
    assert_eq!((both.count, both.of, wrong.count), (1, 1, 0));
}

/// Defect seen: a plunger with an undetermined volume was named. Only half a minute of each log is used, since the
/// diagnosis tries every pair.
#[test]
fn a_bowed_sensor_gets_no_name() {
    const BOW: Hidden = ("sensor_bow", "parabola between 0 and 8 bar", 6.084, 0.730);
    let share = quality_of_part(hiding(59, Class::Beyond, &[BOW]), 3000).named_outside;
    assert_eq!((share.count, share.of), (0, 1));
}

/// Defect seen: steps of the delay of 1 ms left more than a clock between them. It put the rows 10 ms late, and something was said to be
/// missing.
#[test]
fn a_plain_rig_whose_delay_is_between_the_steps_gets_no_clock() {
    let (diagnosis, _) = diagnosed(plain(20_261_130, 60), usize::MAX);
    assert_eq!(
        diagnosis.verdict,
        Verdict::Adequate,
        "{}",
        diagnosis.sentence
    );
    assert!(diagnosis.clocks.is_empty(), "{:?}", diagnosis.clocks);
}

/// Defect seen: a hysteresis was named that explained the training log, and made the error of the validation log larger.
#[test]
fn what_makes_the_validation_worse_gets_no_name() {
    const PULSATION: Hidden = ("supply_pulsation", "sine", 2.493, 0.200);
    let rig = KnownRig {
        seed: 20_261_130,
        ..hiding(81, Class::Beyond, &[PULSATION])
    };
    let share = quality_of(rig).named_outside;
    assert_eq!((share.count, share.of), (0, 1));
}

/// Defect seen: a soft spring imitated the friction, left more than the friction, and the plant file was called wrong.
#[test]
fn friction_is_named_where_a_wrong_spring_explains_less() {
    const FRICTION: Hidden = (
        "static_friction",
        "sliding friction with a surplus at low velocity",
        2.135,
        0.287,
    );
    let rig = KnownRig {
        seed: 20_261_129,
        ..hiding(61, Class::Matched, &[FRICTION])
    };
    assert_named_alone(rig);
}

/// Defect seen: the fit of the side chamber begins far from its end, gained little in its first steps, and was not followed.
#[test]
fn a_side_chamber_is_named_though_its_fit_begins_far_away() {
    const CHAMBER: Hidden = (
        "dead_volume",
        "throttled side chamber, sensor in the chamber",
        5.970,
        0.113,
    );
    let rig = KnownRig {
        seed: 20_261_129,
        ..hiding(100, Class::Variant, &[CHAMBER])
    };
    assert_named_alone(rig);
}

#[test]
fn warm_coils_are_named_after_a_short_log() {
    const WARM: Hidden = warm_coils(2.186, 0.345);
    let short = KnownRig {
        poor: Some(Poor::Short),
        ..hiding(62, Class::Matched, &[WARM])
    };
    assert_named_alone(short);
}
