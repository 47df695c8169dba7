//! Effects in the plant file: their sizes are estimated together with the ordinary parameters.

use plant_sim::PlantParameters;
use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::parameters::Knowledge;
use recording::Recording;

use super::tests::estimated;
use super::*;
use crate::bench::Bench;

const AREA: &str = "effects.chamber_leak.area_m2";

fn with_leak(plant: &PlantParameters, area_m2: f64) -> PlantParameters {
    let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
    plant.with_effect(leak.with("area_m2", area_m2))
}

fn measured(plant: PlantParameters, seed: u64) -> Recording {
    let bench = Bench {
        plant,
        seed,
        ..Bench::default()
    };
    bench.measure()
}

fn found<'a>(estimated: &'a EstimatedPlant, name: &str) -> Vec<&'a EstimatedParameter> {
    let parameters = estimated.estimation.parameters.iter();
    parameters.filter(|one| one.name == name).collect()
}

/// Goal: a rig with a known leak is fitted like one without. Method: the leak of the plant file is a fifth of that of the rig, and flows,
/// preloads and coils are up to 30 % wrong.
#[test]
fn a_known_leak_is_estimated_with_ordinary_values_that_are_a_quarter_off() {
    let mut rig = with_leak(&PlantParameters::nominal(), 2.5e-8);
    rig.flow.discharge_fill *= 0.72;
    rig.flow.discharge_vent *= 1.2;
    rig.armature.preload_fill_n *= 0.88;
    rig.armature.preload_vent_n *= 1.1;
    rig.armature.spring_n_per_m *= 1.2;
    rig.coil.resistance_20c_ohm *= 0.93;
    rig.ecu.command_delay_s = 11e-3;
    rig.gas.supply_pressure_bar_gauge = 8.0;
    let given = with_leak(&PlantParameters::nominal(), 5e-9);
    let found_plant = estimated(
        &given,
        &[measured(rig.clone(), 1)],
        &[measured(rig.clone(), 2)],
    );
    let estimation = &found_plant.estimation;
    assert!(estimation.is_adequate, "{}", estimation.sentence);
    let [given, after] = &estimation.steps[..] else {
        panic!("{:?}", estimation.steps)
    };
    assert!(given.worst_in_noise() > 5.0, "{:?}", given);
    assert!(after.worst_in_noise() < 1.1, "{:?}", after);
    let [leak] = found(&found_plant, AREA)[..] else {
        panic!("{:?}", estimation.parameters)
    };
    assert_eq!(leak.determination, Determination::Determined);
    assert!(leak.low < 2.5e-8 && leak.high > 2.5e-8, "{leak:?}");
    for parameter in &estimation.parameters {
        let truth = rig.get(&parameter.name).unwrap();
        if parameter.determination == Determination::Determined {
            let width = parameter.high - parameter.low;
            assert!(
                truth > parameter.low - 0.5 * width && truth < parameter.high + 0.5 * width,
                "{truth}: {parameter:?}"
            );
        }
    }
    // The refined file has the leak, with its interval; the next fit has the same range.
    let text = found_plant.plant.to_toml();
    let read = PlantParameters::from_toml(&text, "refined").unwrap();
    assert_eq!(read.effects, found_plant.plant.effects);
    assert!(read.provenance[AREA].contains("fitted by retarder refine"));
    assert!(read.provenance[AREA].contains("95 %: "), "{text}");
    assert_eq!(read.knowledge.get(AREA), None);
}

/// Defect seen: a statement about a size made it appear twice in the table, and bounded neither.
#[test]
fn a_size_of_an_effect_keeps_to_what_the_plant_file_states() {
    let log = measured(with_leak(&PlantParameters::nominal(), 2.5e-8), 1);
    let estimated_with = |knowledge| {
        let mut plant = with_leak(&PlantParameters::nominal(), 2e-8);
        for name in ["chamber.volume_m3", "flow.discharge_fill"] {
            plant.knowledge.insert(name.to_owned(), Knowledge::Exact);
        }
        plant.knowledge.insert(AREA.to_owned(), knowledge);
        estimated(&plant, core::slice::from_ref(&log), &[])
    };
    let exact = estimated_with(Knowledge::Exact);
    assert!(found(&exact, AREA).is_empty());
    assert_eq!(exact.plant.get(AREA), Some(2e-8));
    assert_eq!(exact.plant.knowledge[AREA], Knowledge::Exact);

    let bounded = estimated_with(Knowledge::TolerancePct(10.0));
    let [leak] = found(&bounded, AREA)[..] else {
        panic!("{:?}", bounded.estimation.parameters)
    };
    assert_eq!(leak.determination, Determination::AtLimit);
    assert!((leak.after / 2.2e-8 - 1.0).abs() < 1e-6, "{leak:?}");
    let determined_by = leak.determined_by.as_deref();
    assert_eq!(
        determined_by,
        Some("record: both valves shut for 5 s at two pressures")
    );
    // The next run has the same range as this one.
    let Knowledge::Range(least, most) = bounded.plant.knowledge[AREA] else {
        panic!("{:?}", bounded.plant.knowledge)
    };
    assert!((least / 1.8e-8 - 1.0).abs() < 1e-6 && (most / 2.2e-8 - 1.0).abs() < 1e-6);
    let again = PlantParameters::from_toml(&bounded.plant.to_toml(), "again");
    assert!(again.is_ok(), "{again:?}");
}

/// Defect seen: an effect without strength had a coordinate at infinity.
#[test]
fn an_effect_that_is_off_stays_off() {
    let given = with_leak(&PlantParameters::nominal(), 0.0);
    let found_plant = estimated(&given, &[measured(PlantParameters::nominal(), 1)], &[]);
    assert!(found(&found_plant, AREA).is_empty());
    assert!(found_plant.estimation.is_adequate);
    assert_eq!(found_plant.plant.get(AREA), Some(0.0));
}
