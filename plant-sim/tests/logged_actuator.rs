//! Logged position of an actuator that changes the volume of the chamber (E74).

use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::replay::{ReplayError, replay};
use plant_sim::valve::ValveFunction;
use plant_sim::{PlantParameters, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

const STEP_S: f64 = 0.01;
const AREA_M2: f64 = 1e-3;

/// Returns a closed chamber of 100 cm³ with an actuator of 10 cm².
fn cylinder() -> PlantParameters {
    let mut plant = PlantParameters::nominal();
    plant.functions = [ValveFunction::Absent; 2];
    plant.chamber.volume_m3 = 100e-6;
    let effect = EffectSetting::typical(by_id("actuator_volume").unwrap());
    plant.with_effect(effect.with("area_m2", AREA_M2))
}

/// Returns a log of `rows` rows that begins at 1.5 bar gauge, with a position in mm at every `every`-th row.
fn log(rows: usize, every: usize, position_mm: impl Fn(f64) -> f64) -> Recording {
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = log.add_time_base(TimeBase::uniform(0.0, STEP_S, rows).unwrap());
    log.add_signal("p_ch", Unit::BarGauge, base, vec![1.5; rows])
        .unwrap();
    let slow = rows.div_ceil(every);
    let own = log.add_time_base(TimeBase::uniform(0.0, every as f64 * STEP_S, slow).unwrap());
    let positions = (0..slow).map(|row| position_mm((row * every) as f64 * STEP_S));
    log.add_signal("x_actuator", Unit::Millimetre, own, positions.collect())
        .unwrap();
    log
}

/// Returns the simulated chamber pressure (bar abs) of each row.
fn pressures(plant: &PlantParameters, log: &Recording) -> Vec<f64> {
    let replayed = replay(plant, log, Tolerance::scaled(0.01), |_, _| {}).unwrap();
    let pressure = replayed.recording.signal("p_ch").unwrap();
    let ambient_bar = plant.gas.ambient_pressure_pa / 1e5;
    let gauge = pressure.values_or_nan().iter();
    gauge.map(|bar| bar + ambient_bar).collect()
}

/// Boyle, whatever the way: p V is that of the first row, also between two positions of a lower rate.
#[test]
fn the_pressure_of_a_closed_chamber_follows_the_logged_position() {
    let travel_mm = |time_s: f64| 20.0 + 15.0 * (3.0 * time_s).sin();
    for (every, bound) in [(1, 1e-4), (5, 1e-3)] {
        let found = pressures(&cylinder(), &log(300, every, travel_mm));
        for (row, pressure) in found.iter().enumerate().take(290) {
            let volume = |row: usize| 100.0 + travel_mm(row as f64 * STEP_S);
            let expected = found[0] * volume(0) / volume(row);
            assert!(
                (pressure / expected - 1.0).abs() < bound,
                "{every} {row}: {pressure} {expected}"
            );
        }
    }
}

#[test]
fn a_plant_without_the_effect_ignores_the_position() {
    let plant = cylinder().without_effect("actuator_volume");
    for position_mm in [100.0, f64::NAN] {
        let found = pressures(&plant, &log(50, 1, |time_s| position_mm * time_s));
        assert!(found.iter().all(|pressure| *pressure == found[0]));
    }
}

#[test]
fn a_position_that_is_missing_or_leaves_no_volume_is_refused() {
    let refused = |plant: &PlantParameters, log: &Recording| {
        replay(plant, log, Tolerance::default(), |_, _| {}).unwrap_err()
    };
    let plant = cylinder();
    let emptied = log(50, 1, |time_s| -300.0 * time_s);
    let error = refused(&plant, &emptied);
    assert!(matches!(error, ReplayError::NoVolume { .. }), "{error}");
    assert!(error.to_string().contains("-147 mm"), "{error}");

    let without = log(50, 1, |_| 0.0).renamed("x_actuator", "other").unwrap();
    let error = refused(&plant, &without).to_string();
    let names_both = error.contains("x_actuator") && error.contains("effect actuator_volume");
    assert!(names_both, "{error}");

    let empty = log(50, 1, |_| f64::NAN);
    let error = refused(&plant, &empty);
    assert!(matches!(error, ReplayError::EmptyPosition), "{error}");
}
