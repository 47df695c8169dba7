//! Logged supply pressure that drives the plant (E60).

use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::plant::FILL;
use plant_sim::replay::{drives_supply, replay};
use plant_sim::valve::ValveFunction;
use plant_sim::{PlantParameters, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

const STEP_S: f64 = 0.01;
const BAR: f64 = 1e5;

/// Returns a vessel of 20 l that one orifice fills: choked for seconds.
fn vessel() -> PlantParameters {
    let mut plant = PlantParameters::nominal();
    plant.functions = [ValveFunction::AlwaysOpen, ValveFunction::Absent];
    plant.chamber.volume_m3 = 20e-3;
    plant
}

/// Returns a log that begins at ambient pressure, with `p_sup` in `unit`.
fn log(unit: Unit, supply: &[f64]) -> Recording {
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = TimeBase::uniform(0.0, STEP_S, supply.len()).unwrap();
    let base = log.add_time_base(base);
    let pressure = vec![0.0; supply.len()];
    log.add_signal("p_ch", Unit::BarGauge, base, pressure)
        .unwrap();
    log.add_signal("p_sup", unit, base, supply.to_vec())
        .unwrap();
    log
}

/// Returns the simulated chamber pressure (bar gauge).
fn filled(plant: &PlantParameters, log: &Recording) -> Vec<f64> {
    let tolerance = Tolerance::scaled(0.01);
    let replayed = replay(plant, log, tolerance, |_, _| {}).unwrap();
    let pressure = replayed.recording.signal("p_ch").unwrap();
    pressure.values_or_nan().to_vec()
}

/// Returns the rise of the choked pressure (bar) in one row per supply pressure (bar abs), E14.
fn rise_per_row(plant: &PlantParameters) -> f64 {
    let plant = plant.plant();
    let area = plant.valves[FILL].effective_area(0.0);
    plant.chamber.pressure_per_mass * plant.nozzle.choked_factor() * area * STEP_S
}

/// Returns the levels of the supply (bar gauge), 50 rows each.
fn levels() -> Vec<f64> {
    [7.0, 6.0, 8.5, 5.0]
        .iter()
        .flat_map(|&level| [level; 50])
        .collect()
}

#[test]
fn choked_filling_is_the_sum_over_the_supply_pressures_that_were_logged() {
    let plant = vessel();
    let ambient_bar = plant.gas.ambient_pressure_pa / BAR;
    let supply = levels();
    let found = filled(&plant, &log(Unit::BarGauge, &supply));
    let per_row = rise_per_row(&plant);
    let mut expected = 0.0;
    for (row, found) in found.iter().enumerate() {
        assert!((found - expected).abs() < 1e-6, "{row}: {found} {expected}");
        // The value of a row is valid until the next one.
        expected += per_row * (supply[row] + ambient_bar);
    }
    assert!(expected > 0.4, "{expected}");
}

/// The same numbers as absolute pressures are another supply; the same supply gives the same pressures.
#[test]
fn gauge_and_absolute_pressure_are_distinguished() {
    let plant = vessel();
    let ambient_bar = plant.gas.ambient_pressure_pa / BAR;
    let absolute: Vec<f64> = levels().iter().map(|bar| bar + ambient_bar).collect();
    let [gauge, absolute] = [
        filled(&plant, &log(Unit::BarGauge, &levels())),
        filled(&plant, &log(Unit::BarAbsolute, &absolute)),
    ];
    let pairs = gauge.iter().zip(&absolute);
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-9));
}

#[test]
fn missing_and_impossible_cells_hold_the_last_value() {
    let plant = vessel();
    let mut supply = levels();
    let mut held = supply.clone();
    supply[60..70].fill(f64::NAN);
    // A sensor without supply, and one with a broken wire.
    supply[110] = -1.1;
    supply[111] = 900.0;
    // Before the first sample, the first sample is used.
    supply[0] = f64::NAN;
    held[60..70].fill(6.0);
    held[110..112].fill(8.5);
    let found = filled(&plant, &log(Unit::BarGauge, &supply));
    let expected = filled(&plant, &log(Unit::BarGauge, &held));
    assert_eq!(found, expected);
}

#[test]
fn what_the_gauge_shows_too_much_is_taken_off() {
    let mut plant = vessel();
    let expected = filled(&plant, &log(Unit::BarGauge, &levels()));
    plant
        .set(
            "gas.supply_gauge_offset_bar",
            0.3,
            "compared with a second gauge",
        )
        .unwrap();
    let shown: Vec<f64> = levels().iter().map(|bar| bar + 0.3).collect();
    let found = filled(&plant, &log(Unit::BarGauge, &shown));
    let pairs = found.iter().zip(&expected);
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-9));
    let read = PlantParameters::from_toml(&plant.to_toml(), "rig.toml").unwrap();
    assert_eq!(read.gas.supply_gauge_offset_bar, 0.3);
}

/// A small chamber reaches the supply pressure, and follows a falling supply: the open valve lets air back.
#[test]
fn a_supply_that_gives_way_takes_air_back() {
    let mut plant = vessel();
    plant.chamber.volume_m3 = 75e-6;
    let mut supply = vec![8.0; 200];
    supply[100..].fill(3.0);
    let found = filled(&plant, &log(Unit::BarGauge, &supply));
    assert!((found[99] - 8.0).abs() < 1e-3, "{}", found[99]);
    assert!((found[199] - 3.0).abs() < 1e-3, "{}", found[199]);
}

/// The logged pressure is upstream of the line: the line of a `supply_line_droop` draws from it, and begins at rest
/// with it.
#[test]
fn a_supply_line_draws_from_the_logged_pressure() {
    let droop = by_id("supply_line_droop").unwrap();
    for variant in droop.about().variants {
        let mut plant = vessel().with_effect(EffectSetting::typical_variant(droop, variant));
        let expected = {
            plant.gas.supply_pressure_bar_gauge = 5.0;
            let mut log = log(Unit::BarGauge, &[5.0; 200]);
            log = without_supply(&log);
            filled(&plant, &log)
        };
        plant.gas.supply_pressure_bar_gauge = 8.0;
        let found = filled(&plant, &log(Unit::BarGauge, &[5.0; 200]));
        for (found, expected) in found.iter().zip(&expected) {
            assert!(
                (found - expected).abs() < 1e-6,
                "{}: {found} {expected}",
                variant.name
            );
        }
    }
}

fn without_supply(log: &Recording) -> Recording {
    let mut bare = Recording::new(log.provenance().clone());
    let (_, base) = log.time_bases().next().unwrap();
    let id = bare.add_time_base(base.clone());
    let pressure = log.signal("p_ch").unwrap();
    bare.add_signal(
        "p_ch",
        pressure.unit(),
        id,
        pressure.values_or_nan().to_vec(),
    )
    .unwrap();
    bare
}

/// The value of a gauge that was sampled more slowly is valid until the next one.
#[test]
fn a_supply_with_a_rate_of_its_own_is_held() {
    let plant = vessel();
    let mut slow = without_supply(&log(Unit::BarGauge, &levels()));
    let id = slow.add_time_base(TimeBase::uniform(0.0, 0.5, 4).unwrap());
    slow.add_signal("p_sup", Unit::BarGauge, id, vec![7.0, 6.0, 8.5, 5.0])
        .unwrap();
    let found = filled(&plant, &slow);
    assert_eq!(found, filled(&plant, &log(Unit::BarGauge, &levels())));
}

#[test]
fn a_supply_that_cannot_drive_says_why() {
    let mut plant = vessel();
    let reason = drives_supply(&plant, &log(Unit::BarGauge, &[400.0; 20])).unwrap_err();
    assert!(reason.contains("look at its unit"), "{reason}");
    let reason = drives_supply(&plant, &log(Unit::Volt, &[4.0; 20])).unwrap_err();
    assert!(reason.contains("p_sup"), "{reason}");
    plant.functions = [ValveFunction::Absent, ValveFunction::AlwaysOpen];
    let reason = drives_supply(&plant, &log(Unit::BarGauge, &[4.0; 20])).unwrap_err();
    assert!(reason.contains("no fill valve"), "{reason}");
}
