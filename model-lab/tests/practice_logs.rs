//! Bundled bench logs with known noise (data/README.md).

use std::path::PathBuf;

use model_lab::result::{Comparison, SignalComparison};
use model_lab::{CompareOptions, compare};
use plant_sim::PlantParameters;
use recording::csv;

fn compared(log: &str, parameters: &PlantParameters) -> Comparison {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../data/synthetic");
    // Adds the command that the scope logs lack; the other logs are unchanged.
    let options = csv::Options {
        mapping: csv::Mapping::read_file(folder.join("scope.toml")).unwrap(),
        ..csv::Options::default()
    };
    let log = csv::read_file(folder.join(log), &options).unwrap();
    compare(parameters, &log, &CompareOptions::default()).unwrap()
}

fn signal<'a>(comparison: &'a Comparison, name: &str) -> &'a SignalComparison {
    comparison
        .signals
        .iter()
        .find(|signal| signal.name == name)
        .unwrap()
}

/// The floor is that of the sensor, whatever effect the rig hides (leaks, hot coils, lagging sensors).
#[test]
fn noise_floors_are_those_of_the_sensors_on_every_rig() {
    let with_resolution = |sigma: f64, step: f64| f64::hypot(sigma, step / 12_f64.sqrt());
    let pressure_bar = with_resolution(4e-3, 5.1e-3);
    let current_ma = with_resolution(0.7, 0.5);
    for rig in 0..=8 {
        let comparison = compared(
            &format!("practice-{rig:02}-id.csv"),
            &PlantParameters::nominal(),
        );
        for (name, expected) in [
            ("p_ch", pressure_bar),
            ("i_fill", current_ma),
            ("i_vent", current_ma),
        ] {
            let floor = signal(&comparison, name).noise_floor.value.unwrap();
            assert!(
                (floor / expected - 1.0).abs() < 0.05,
                "rig {rig}, {name}: {floor}, expected {expected}"
            );
        }
    }
}

/// Rig 0 hides no effect, but its supply pressure, orifices and delay differ from the nominal plant.
#[test]
fn scatter_of_the_rig_is_placed_where_it_acts() {
    let comparison = compared("practice-00-id.csv", &PlantParameters::nominal());
    assert_eq!(comparison.verdict.failing, ["p_ch", "i_fill", "i_vent"]);
    let pressure = &signal(&comparison, "p_ch").finding.sentence;
    assert!(pressure.contains("filling above 8"), "{pressure}");
    for name in ["i_fill", "i_vent"] {
        let sentence = &signal(&comparison, name).finding.sentence;
        assert!(sentence.contains("after a switch"), "{sentence}");
        let offset = signal(&comparison, name).time_offset.as_ref().unwrap();
        assert!(
            (1.0..2.0).contains(&offset.lag_ms) && offset.mismatch_explained > 0.8,
            "{offset:?}"
        );
    }
}

#[test]
fn a_shut_valve_pair_leaves_no_excess_on_the_rig_without_leak() {
    let comparison = compared("practice-00-id.csv", &PlantParameters::nominal());
    let valves = &signal(&comparison, "p_ch").regimes[0];
    let shut = valves
        .bins
        .iter()
        .find(|bin| bin.label == "both valves shut")
        .unwrap();
    let share = shut.one_step_ahead.as_ref().unwrap().excess_share.unwrap();
    assert!(share.abs() < 0.01 && shut.sample_share > 0.3, "{shut:?}");
}

/// The current differs only by the rig's command delay.
#[test]
fn a_scope_log_is_compared_in_current_alone() {
    let mut parameters = PlantParameters::nominal();
    parameters
        .set("gas.supply_pressure_bar_gauge", 0.0, "disconnected")
        .unwrap();
    let comparison = compared("practice-00-scope-75.csv", &parameters);
    assert_eq!(comparison.signals.len(), 1);
    let current = signal(&comparison, "i_fill");
    let offset = current.time_offset.as_ref().unwrap();
    assert!(
        (1.0..2.0).contains(&offset.lag_ms) && offset.mismatch_explained > 0.95,
        "{offset:?}"
    );
    assert_eq!(comparison.predictor, None);
}
