use core::ops::ControlFlow;
use std::collections::BTreeMap;

use plant_sim::PlantParameters;
use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::logger_clock::LoggerClock;
use recording::Recording;

use super::result::{Diagnosis, OutsideValue, StepKind, Verdict};
use super::{assemble, diagnose, diagnose_with, fix};
use crate::bench::{Bench, logged};

/// A bench whose plant has been changed.
fn bench(change: impl FnOnce(&mut PlantParameters)) -> Bench {
    let mut bench = Bench::default();
    change(&mut bench.plant);
    bench
}

fn leaking() -> Bench {
    let leak = EffectSetting::typical(by_id("chamber_leak").unwrap()).with("area_m2", 3e-8);
    bench(|plant| *plant = plant.clone().with_effect(leak))
}

fn diagnosed(plant: &PlantParameters, log: Recording) -> Diagnosis {
    diagnose(plant, &[log], &[], &|_| ControlFlow::Continue(())).unwrap()
}

fn kinds(diagnosis: &Diagnosis) -> Vec<StepKind> {
    diagnosis.ladder.iter().map(|step| step.kind).collect()
}

/// An orifice 30 % smaller than in the plant file was named a restriction, or nothing was named.
#[test]
fn a_plant_file_that_is_wrong_is_told_and_no_effect_is_named() {
    let rig = bench(|plant| plant.flow.discharge_fill *= 0.7);
    let diagnosis = diagnosed(&PlantParameters::nominal(), rig.measure());
    let said = &diagnosis.sentence;
    assert_eq!(diagnosis.verdict, Verdict::PlantFileWrong, "{said}");
    assert!(diagnosis.effects.is_empty(), "{said}");
    let outside = diagnosis.outside.iter();
    let wrong = outside
        .clone()
        .find(|one| one.name == "flow.discharge_fill");
    let ratio = wrong.unwrap().value / rig.plant.flow.discharge_fill;
    assert!((ratio - 1.0).abs() < 0.05, "{said}");
    assert!(said.starts_with("the plant file is wrong here: "), "{said}");
    let steps = [
        StepKind::PlantAsGiven,
        StepKind::ParametersRefitted,
        StepKind::RangesWidened,
    ];
    assert_eq!(kinds(&diagnosis), steps);
    let errors: Vec<f64> = diagnosis
        .ladder
        .iter()
        .map(|step| step.worst_in_noise())
        .collect();
    assert!(errors[1] > errors[2], "{errors:?}");
}

/// Values of a first file lay so far off that iron saturation was named beside the leak, which makes up for a wrong force.
#[test]
fn a_leak_is_told_beside_a_first_file_that_is_far_off() {
    let mut plant = PlantParameters::nominal();
    plant.flow.discharge_fill *= 0.75;
    plant.flow.discharge_vent *= 0.75;
    plant.magnet.force_constant_n_m2_per_a2 *= 1.25;
    plant.armature.preload_fill_n *= 1.25;
    plant.armature.spring_n_per_m *= 0.75;
    let library = ["chamber_leak", "iron_saturation", "sensor_lag"];
    let library: Vec<_> = library.iter().filter_map(|id| by_id(id)).collect();
    let log = logged(&leaking().plant, LoggerClock::default(), 0.01, 1);
    let watch = |_| ControlFlow::Continue(());
    let diagnosis = diagnose_with(&library, &plant, &[log], &[], &watch).unwrap();
    let said = &diagnosis.sentence;
    assert_eq!(diagnosis.effects, ["chamber_leak"], "{said}");
    assert!(said.contains("the plant file is wrong as well"), "{said}");
    let steps = [
        StepKind::PlantAsGiven,
        StepKind::ParametersRefitted,
        StepKind::RangesWidened,
        StepKind::EffectAdded,
    ];
    assert_eq!(kinds(&diagnosis), steps);
    let far = |name: &str| diagnosis.outside.iter().any(|value| value.name == name);
    assert!(far("armature.spring_n_per_m"), "{:?}", diagnosis.outside);
    assert!(!far("coil.resistance_20c_ohm"), "{:?}", diagnosis.outside);
}

/// A value that is known exactly is not widened: physics has to explain what it does not.
#[test]
fn an_exact_value_is_not_doubted() {
    let rig = bench(|plant| plant.flow.discharge_fill *= 0.7);
    let mut plant = PlantParameters::nominal();
    fix(&mut plant, "flow.discharge_fill").unwrap();
    let diagnosis = diagnosed(&plant, rig.measure());
    let doubted = diagnosis
        .outside
        .iter()
        .any(|one| one.name == "flow.discharge_fill");
    assert!(!doubted, "{}", diagnosis.sentence);
}

/// The refit is a step of its own, so that an effect is credited with what it does alone.
#[test]
fn the_steps_begin_with_the_plant_as_given() {
    let diagnosis = diagnosed(&PlantParameters::nominal(), leaking().measure());
    assert_eq!(diagnosis.verdict, Verdict::Found, "{}", diagnosis.sentence);
    let steps = [
        StepKind::PlantAsGiven,
        StepKind::ParametersRefitted,
        StepKind::EffectAdded,
    ];
    assert_eq!(kinds(&diagnosis), steps);
}

/// Less noise once made the error of the model look like physics, and its intervals so wide that a rule vetoed the name.
#[test]
fn a_better_sensor_costs_no_name() {
    for share in [1.0, 1.0 / 3.0, 1.0 / 10.0, 1.0 / 30.0] {
        let mut rig = leaking();
        rig.pressure_noise.0 *= share;
        let diagnosis = diagnosed(&PlantParameters::nominal(), rig.measure());
        let said = &diagnosis.sentence;
        assert_eq!(diagnosis.effects, ["chamber_leak"], "{share}: {said}");
        assert_eq!(diagnosis.verdict, Verdict::Found, "{share}: {said}");
    }
}

/// What is of no interest to the user is no missing physics.
#[test]
fn an_error_that_is_not_needed_counts_as_noise() {
    let mut log = leaking().measure();
    log.set_need("p_ch", 2.0);
    let diagnosis = diagnosed(&PlantParameters::nominal(), log);
    assert_eq!(
        diagnosis.verdict,
        Verdict::Adequate,
        "{}",
        diagnosis.sentence
    );
}

/// A narrow fitting and a narrower orifice look alike: the value is the answer, and the fitting is told.
#[test]
fn what_explains_as_much_as_a_wrong_value_is_told() {
    let outside = OutsideValue {
        name: "flow.discharge_fill".to_owned(),
        unit: String::new(),
        value: 0.738,
        least: 0.855,
        most: 1.04,
    };
    let said = |rivals: &[String]| {
        let about = (&[][..], &[outside.clone()][..], rivals);
        let none = BTreeMap::new();
        assemble::sentence(Verdict::PlantFileWrong, &[], about, &none, true)
    };
    let alone = said(&[]);
    assert!(
        alone.ends_with("with this value nothing detectable is missing"),
        "{alone}"
    );
    let rival = said(&["series_restriction".to_owned()]);
    let either = format!(
        "{alone}; or the file is right and series restriction is missing, which explains the error as well"
    );
    assert_eq!(rival, either);
}
