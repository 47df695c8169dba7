//! Diagnosis of the bundled rigs (data/README.md), with the results of docs/evidence.md.

mod practice;

use core::ops::ControlFlow;

use model_lab::diagnosis::result::{Candidate, Diagnosis, FittedParameter, Verdict};
use model_lab::diagnosis::{diagnose, diagnose_with};
use plant_sim::PlantParameters;
use plant_sim::effects::by_id;

/// Returns the length of the used part of a log (s). The first half shows the hidden effect in half the time, except for a coil, which
/// warms over a minute.
fn seconds(rig: u8) -> usize {
    match rig {
        2 | 7 => 60,
        _ => 30,
    }
}

fn diagnosed(rig: u8) -> Diagnosis {
    let read = |kind: &str| {
        [practice::beginning(
            &format!("practice-{rig:02}-{kind}.csv"),
            seconds(rig),
        )]
    };
    let watch = |_| ControlFlow::Continue(());
    diagnose(
        &PlantParameters::nominal(),
        &read("id"),
        &read("check"),
        &watch,
    )
    .unwrap()
}

fn candidate<'a>(diagnosis: &'a Diagnosis, effect: &str) -> &'a Candidate {
    let mut candidates = diagnosis.candidates.iter();
    candidates
        .find(|candidate| candidate.effect == effect)
        .unwrap()
}

fn fitted<'a>(diagnosis: &'a Diagnosis, effect: &str, key: &str) -> &'a FittedParameter {
    let mut parameters = candidate(diagnosis, effect).parameters.iter();
    parameters.find(|parameter| parameter.key == key).unwrap()
}

/// Asserts the requirement on every rig with hidden effects of the library: the effects are found, only they are named, and the error is at
/// the noise floor.
fn assert_found(diagnosis: &Diagnosis, effects: &[&str]) {
    assert_eq!(diagnosis.verdict, Verdict::Found, "{}", diagnosis.sentence);
    assert_eq!(diagnosis.effects, effects);
    assert!(!diagnosis.unexplained);
    for effect in effects {
        assert_eq!(diagnosis.equivalents[*effect], [*effect]);
    }
    for candidate in &diagnosis.candidates {
        // Defect seen: a form with one parameter was listed with the two parameters of the form that was fitted together with the other
        // effect.
        let about = by_id(&candidate.effect).unwrap().about();
        let form = about.variant(&candidate.variant).unwrap();
        let keys: Vec<&str> = form.parameters.iter().map(|spec| spec.key).collect();
        let fitted: Vec<&str> = candidate.parameters.iter().map(|one| &*one.key).collect();
        assert!(fitted.is_empty() || fitted == keys, "{candidate:?}");
    }
    let last = diagnosis.error_steps.last().unwrap();
    for (signal, rms) in &last.check_rms {
        let ratio = rms / last.noise_floor[signal];
        assert!(ratio < 1.1, "{signal}: {ratio:.2} noise floors remain");
    }
}

fn assert_contains(parameter: &FittedParameter, truth: f64) {
    assert!(
        parameter.low <= truth && truth <= parameter.high,
        "{}: {:.4e} is not in {:.4e} to {:.4e}",
        parameter.key,
        truth,
        parameter.low,
        parameter.high
    );
    // An interval that contains everything is no information.
    assert!(parameter.high / parameter.low < 1.5, "{parameter:?}");
}

#[test]
fn rig_0_lacks_nothing_and_lists_its_detection_limits() {
    let diagnosis = diagnosed(0);
    assert_eq!(
        diagnosis.verdict,
        Verdict::Adequate,
        "{}",
        diagnosis.sentence
    );
    assert!(diagnosis.effects.is_empty() && diagnosis.equivalents.is_empty());
    assert_eq!(diagnosis.candidates.len(), 21);
    assert!(
        diagnosis
            .nuisance
            .iter()
            .all(|nuisance| nuisance.alarm.is_none())
    );
}

#[test]
fn rig_1_leaks() {
    let diagnosis = diagnosed(1);
    assert_found(&diagnosis, &["chamber_leak"]);
    assert_contains(fitted(&diagnosis, "chamber_leak", "area_m2"), 2.1e-8);
}

#[test]
fn rig_2_heats_its_coils() {
    let diagnosis = diagnosed(2);
    assert_found(&diagnosis, &["coil_heating"]);
    let capacity = fitted(&diagnosis, "coil_heating", "heat_capacity_j_per_k");
    assert_contains(capacity, 23.0);
}

#[test]
fn rig_3_saturates() {
    assert_found(&diagnosed(3), &["iron_saturation"]);
}

#[test]
fn rig_4_has_a_narrow_supply_line() {
    let diagnosis = diagnosed(4);
    assert_found(&diagnosis, &["supply_line_droop"]);
    let of = |key| fitted(&diagnosis, "supply_line_droop", key);
    assert_contains(of("restriction_area_m2"), 3.25e-6);
    assert_contains(of("line_volume_m3"), 7e-5);
    // Without the effect, the ordinary parameters were distorted.
    let is_distorted = |name: &str| {
        let mut nuisance = diagnosis.nuisance.iter();
        nuisance.any(|nuisance| nuisance.name == name && nuisance.alarm.is_some())
    };
    assert!(is_distorted("flow.discharge_fill"));
}

#[test]
fn rig_5_warms_its_gas() {
    let diagnosis = diagnosed(5);
    assert_found(&diagnosis, &["gas_temperature"]);
    let heat = fitted(&diagnosis, "gas_temperature", "wall_heat_transfer_w_per_k");
    assert_contains(heat, 0.07);
}

#[test]
fn rig_6_has_a_slow_sensor() {
    let diagnosis = diagnosed(6);
    assert_found(&diagnosis, &["sensor_lag"]);
    assert_contains(fitted(&diagnosis, "sensor_lag", "time_constant_s"), 0.012);
}

#[test]
fn rig_7_leaks_and_heats_its_coils() {
    let diagnosis = diagnosed(7);
    assert_found(&diagnosis, &["chamber_leak", "coil_heating"]);
    assert_contains(fitted(&diagnosis, "chamber_leak", "area_m2"), 2.1e-8);
    let capacity = fitted(&diagnosis, "coil_heating", "heat_capacity_j_per_k");
    assert_contains(capacity, 23.0);
}

#[test]
fn rig_8_lacks_something_that_the_library_has_not() {
    let diagnosis = diagnosed(8);
    assert_eq!(
        diagnosis.verdict,
        Verdict::NotInLibrary,
        "{}",
        diagnosis.sentence
    );
    assert!(diagnosis.effects.is_empty() && diagnosis.unexplained);
}

/// The supply of rig 8 oscillates at 0.45 Hz. The whole log has enough periods to show it; half of it does not.
#[test]
fn rig_8_swings_at_a_line_of_its_own() {
    let read = |kind: &str| [practice::log(&format!("practice-08-{kind}.csv"))];
    let watch = |_| ControlFlow::Continue(());
    let plant = PlantParameters::nominal();
    let diagnosis = diagnose_with(&[], &plant, &read("id"), &read("check"), &watch).unwrap();
    let strongest = &diagnosis.remaining.spectral_lines[0];
    assert!(
        (strongest.frequency_hz - 0.45).abs() < 0.005,
        "{strongest:?}"
    );
}
