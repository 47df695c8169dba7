//! Rigs of other kinds from an independent plant, from a fresh folder through the steps of `docs/your-rig.md`: inspect
//! the logs, write the plant file from the plate, refine, diagnose.
//!
//! The steps are those of the commands, called in the libraries: the binary is built by another package. A command ends
//! with status 0 if the verdict is `Adequate` and with 1 if it is `Found`; `refine` ends with 0.

use core::ops::ControlFlow;
use std::fs;
use std::path::Path;

use model_lab::diagnosis::result::{Diagnosis, NuisanceValue, Verdict};
use model_lab::diagnosis::{Known, diagnose, estimate, known};
use plant_sim::PlantParameters;
use recording::{LogOptions, Recording, inspect_file, read_log_file};
use retarder_tests::blind::format::Folders;
use retarder_tests::blind::kinds::draw::{KindsDraw, Wishes};
use retarder_tests::blind::kinds::format::Kind;

/// Share of the fitted ordinary values whose 95 % interval has to contain the true one.
const COVERAGE_MIN: f64 = 0.8;
/// Seed. Of the few rigs of each kind that were tried, those below are fast ones; all of these were right.
const SEED: u64 = 1;

/// Leads the rig with this number to its diagnosis, and asserts that its one hidden effect is named alone.
fn check(number: usize, kind: Kind) {
    // Short logs of a fast logger, for speed.
    let wishes = Wishes {
        effects: Some(1),
        lengths_s: Some([20.0, 10.0]),
        rate_hz: Some(200.0),
    };
    let drawn = KindsDraw::new(SEED, number, wishes).rig(number);
    assert_eq!(drawn.answer.kind, kind);
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders::new(folder.path());
    fs::create_dir(folders.logs()).unwrap();
    let rig = &drawn.answer.rig;
    let paths = [folders.id_log(rig), folders.check_log(rig)];
    for (path, text) in paths.iter().zip(&drawn.logs) {
        fs::write(path, text).unwrap();
    }

    let [id, validation] = paths.each_ref().map(|path| inspected(path));
    let plant = PlantParameters::from_datasheet(&drawn.plate, "plate").unwrap();
    let truth = PlantParameters::from_datasheet(&drawn.true_plate, "true plate").unwrap();
    assert_within_the_plate(&plant, &truth);

    let watch = |_| ControlFlow::Continue(());
    let estimated = estimate(&plant, &id, &validation, &watch).unwrap();
    let estimation = estimated.estimation;
    assert!(!estimation.is_adequate, "{}", estimation.sentence);
    let diagnosis = diagnose(&plant, &id, &validation, &watch).unwrap();
    let said = &diagnosis.sentence;
    assert_eq!(diagnosis.verdict, Verdict::Found, "{said}");
    let hidden: Vec<&String> = drawn.answer.effects.keys().collect();
    let named: Vec<&String> = diagnosis.effects.iter().collect();
    assert_eq!(named, hidden, "{said}");
    assert_intervals_contain(&diagnosis, &truth);
}

/// Reads a log that is ready to be read, as its inspection says.
fn inspected(path: &Path) -> [Recording; 1] {
    let options = LogOptions::default();
    let inspection = inspect_file(path, &options, None).unwrap();
    assert!(inspection.is_ready(), "{inspection:?}");
    [read_log_file(path, &options).unwrap()]
}

/// Asserts that the plant file admits the true value of each parameter that the plate states.
fn assert_within_the_plate(plant: &PlantParameters, truth: &PlantParameters) {
    let mut count = 0;
    for spec in plant.specs() {
        let name = spec.name();
        if let Some(Known::Stated { within, .. }) = known(plant, &name) {
            let value = truth.get(&name).unwrap();
            let rounding = 1e-9 * value.abs();
            let (least, most) = (within.0 - rounding, within.1 + rounding);
            assert!(
                (least..=most).contains(&value),
                "{name}: {value} {within:?}"
            );
            count += 1;
        }
    }
    assert!(count > 10, "the plate states {count} values");
}

/// Asserts that the intervals of the ordinary values contain the true ones, but for a few.
fn assert_intervals_contain(diagnosis: &Diagnosis, truth: &PlantParameters) {
    let off: Vec<(&str, f64)> = diagnosis
        .nuisance
        .iter()
        .filter_map(|value| {
            Some((
                &value.name[..],
                half_widths_off(value, truth.get(&value.name)?),
            ))
        })
        .collect();
    let within = off.iter().filter(|(_, off)| *off <= 1.0).count();
    assert!(
        within as f64 >= COVERAGE_MIN * off.len() as f64 && off.len() > 10,
        "{within} of {}: {off:.2?}",
        off.len()
    );
}

/// Returns the distance of the true value from the middle of an interval, in half widths.
fn half_widths_off(value: &NuisanceValue, truth: f64) -> f64 {
    let middle = 0.5 * (value.low + value.high);
    (truth - middle).abs() / (0.5 * (value.high - value.low))
}

#[test]
fn a_pair_of_on_off_valves_is_led_from_its_plate_to_its_hidden_effect() {
    check(25, Kind::OnOff);
}

/// Defect seen: its logs leave a delay open, and the leak was named as one whose law differs.
#[test]
fn a_hose_is_led_from_its_plate_to_its_hidden_effect() {
    check(22, Kind::Hose);
}

/// Its delays depend on the pressure, and on the supply voltage of the log.
#[test]
fn valves_that_open_late_at_a_low_voltage_are_led_to_their_delay() {
    check(30, Kind::Hose);
}

#[test]
fn a_second_chamber_is_led_from_its_plate_to_its_hidden_effect() {
    check(31, Kind::SecondChamber);
}

/// Defects seen: the opening of the model lagged, where the spool does. An offset that is far above the typical one was not
/// tried.
#[test]
fn a_proportional_valve_is_led_from_its_plate_to_its_hidden_effect() {
    check(4, Kind::Proportional);
}

#[test]
fn a_chamber_with_a_moving_piston_is_led_from_its_plate_to_its_hidden_effect() {
    check(32, Kind::Proportional);
}
