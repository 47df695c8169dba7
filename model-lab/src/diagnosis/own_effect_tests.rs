//! User's own effects of a plant file: a rig hides one, and the candidate of its law is named and fitted.

use core::ops::ControlFlow;

use plant_sim::PlantParameters;
use recording::Recording;

use super::Diagnosis;
use super::diagnose;
use super::refine;
use super::result::Verdict;
use crate::bench::Bench;

/// Leak that the library does not have, in a form that it can only approach.
const SEAL: &str = r#"
[own_effects.lifting_seal]
sentence = "The lip of the shaft seal lifts above a pressure, and air escapes past it."
acts_on = "leak_flow"
expression = "k * max(p - p_lift, 0)"
excited_by = "a hold above and one below the pressure at which the lip lifts"
parameters.k = { typical = 1e-10, range = [1e-12, 1e-8], unit = "kg/s/Pa" }
parameters.p_lift = { typical = 4e5, range = [1.5e5, 9e5], unit = "Pa" }
"#;

/// Sensor whose characteristic is bent.
const BENT: &str = r#"
[own_effects.bent_sensor]
sentence = "The characteristic of the sensor is bent: it shows too much in the middle of its range."
acts_on = "sensor_output"
expression = "top * 4 * (p - p_ambient) * (span - p + p_ambient) / span ^ 2"
parameters.top = { typical = 5e3, range = [-1e5, 1e5], unit = "Pa" }
parameters.span = { typical = 8e5, range = [4e5, 1.2e6], unit = "Pa" }
"#;

/// Returns the nominal plant with these further tables.
fn with_tables(tables: &str) -> PlantParameters {
    let text = format!("{}\n{tables}", PlantParameters::nominal().to_toml());
    PlantParameters::from_toml(&text, "rig.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Returns logs of a rig that differs from the file in ordinary values, for training and validation.
fn logs_of(rig: &PlantParameters) -> [Recording; 2] {
    [1, 2].map(|seed| {
        let mut plant = rig.clone();
        plant.chamber.volume_m3 *= 1.03;
        plant.flow.discharge_fill *= 0.98;
        let bench = Bench {
            plant,
            seed,
            ..Bench::default()
        };
        bench.measure()
    })
}

fn diagnosed(plant: &PlantParameters, [fitted, check]: &[Recording; 2]) -> Diagnosis {
    let goes_on = |_| ControlFlow::Continue(());
    let fitted = core::slice::from_ref(fitted);
    let check = core::slice::from_ref(check);
    diagnose(plant, fitted, check, &goes_on).unwrap()
}

/// Checks that a diagnosis with the whole library names the hidden effect `id`, with its sentence, and `truth` within
/// the intervals of its parameters.
fn check(definition: &str, id: &str, truth: &[(&str, f64)]) {
    let values: Vec<String> = truth
        .iter()
        .map(|(key, value)| format!("{key} = {value:e}"))
        .collect();
    let hidden = format!("{definition}\n[effects.{id}]\n{}\n", values.join("\n"));
    let logs = logs_of(&with_tables(&hidden));
    let plant = with_tables(definition);
    let diagnosis = diagnosed(&plant, &logs);
    assert_eq!(diagnosis.verdict, Verdict::Found, "{}", diagnosis.sentence);
    assert_eq!(diagnosis.effects, [id], "{}", diagnosis.sentence);
    let named = diagnosis
        .candidates
        .iter()
        .find(|one| one.effect == id)
        .unwrap();
    assert!(definition.contains(&named.physics), "{}", named.physics);
    for (key, value) in truth {
        let fitted = named.parameters.iter().find(|one| one.key == *key).unwrap();
        assert!((fitted.low..=fitted.high).contains(value), "{fitted:?}");
        assert!(!fitted.at_bound, "{fitted:?}");
        assert!(
            (fitted.value / value - 1.0).abs() < 0.15,
            "{fitted:?} {value}"
        );
    }
    // The plant that the page and the report simulate has the effect, too.
    let [_, refined] = diagnosis.plain_and_refined(&plant);
    assert!(refined.effect(id).is_some());
    // The same by request, and the refined file is read.
    let [fitted, check] = logs.each_ref().map(core::slice::from_ref);
    let goes_on = |_| ControlFlow::Continue(());
    let refined = refine(&plant, fitted, check, &[(id.to_owned(), None)], &goes_on).unwrap();
    let written = refined.plant.to_toml();
    let read = PlantParameters::from_toml(&written, "refined.toml").unwrap();
    for (key, value) in truth {
        let name = format!("effects.{id}.{key}");
        let found = read.get(&name).unwrap();
        assert!((found / value - 1.0).abs() < 0.15, "{key}: {found} {value}");
        let origin = &read.provenance[&name];
        assert!(
            origin.starts_with("fitted by retarder refine to "),
            "{origin}"
        );
    }
}

#[test]
fn a_hidden_leak_of_an_own_law_is_named_with_its_parameters() {
    check(
        SEAL,
        "own.lifting_seal",
        &[("k", 2.5e-10), ("p_lift", 5.5e5)],
    );
}

#[test]
fn a_hidden_bent_characteristic_of_the_sensor_is_named_with_its_parameters() {
    check(BENT, "own.bent_sensor", &[("top", 1.2e4), ("span", 9e5)]);
}

/// A definition alone is a candidate, and no part of the plant: on a rig without it nothing is named.
#[test]
fn an_own_effect_that_the_rig_does_not_have_is_not_named() {
    let plant = with_tables(&format!("{SEAL}{BENT}"));
    let diagnosis = diagnosed(&plant, &logs_of(&PlantParameters::nominal()));
    assert_eq!(diagnosis.effects, [] as [&str; 0], "{}", diagnosis.sentence);
    assert_eq!(
        diagnosis.verdict,
        Verdict::Adequate,
        "{}",
        diagnosis.sentence
    );
    assert!(
        diagnosis
            .candidates
            .iter()
            .any(|one| one.effect == "own.bent_sensor")
    );
}

/// A misspelled id is answered with the one that was probably meant.
#[test]
fn an_own_effect_that_is_not_defined_is_refused_with_the_nearest() {
    let plant = with_tables(SEAL);
    let [log, _] = logs_of(&plant);
    let goes_on = |_| ControlFlow::Continue(());
    let add = [("own.lifting_sael".to_owned(), None)];
    let error = refine(&plant, &[log], &[], &add, &goes_on).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("did you mean `own.lifting_seal`"),
        "{error}"
    );
}
