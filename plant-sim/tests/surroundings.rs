//! Surroundings measured with a log.

use plant_sim::plant::FILL;
use plant_sim::replay::{ReplayError, Surroundings, replay};
use plant_sim::valve::ValveFunction;
use plant_sim::{PlantParameters, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

const ROWS: usize = 100;
const STEP_S: f64 = 0.01;

/// Returns a log with one row every 10 ms.
fn log(signals: &[(&str, Unit, f64)]) -> Recording {
    let mut log = Recording::new(Provenance::from_source("bench.csv"));
    let base = log.add_time_base(TimeBase::uniform(0.0, STEP_S, ROWS).unwrap());
    for &(name, unit, value) in signals {
        log.add_signal(name, unit, base, vec![value; ROWS]).unwrap();
    }
    log
}

fn last(plant: &PlantParameters, log: &Recording, name: &str) -> f64 {
    let replayed = replay(plant, log, Tolerance::scaled(0.01), |_, _| {}).unwrap();
    let signal = replayed.recording.signal(name).unwrap();
    *signal.values_or_nan().last().unwrap()
}

/// Returns a vessel of 20 l that one orifice fills: choked for seconds.
fn vessel() -> PlantParameters {
    let mut plant = PlantParameters::nominal();
    plant.functions = [ValveFunction::AlwaysOpen, ValveFunction::Absent];
    plant.chamber.volume_m3 = 20e-3;
    plant
}

/// E14: the choked rise is proportional to the absolute supply pressure and to the root of the temperature.
#[test]
fn choked_filling_knows_the_pressure_and_the_temperature_of_its_surroundings() {
    let plant = vessel();
    let area = plant.plant().valves[FILL].effective_area(0.0);
    let gas = &plant.gas;
    let found = last(
        &plant,
        &log(&[
            ("p_ch", Unit::BarGauge, 0.0),
            ("p_amb", Unit::MillibarAbsolute, 800.0),
            ("t_amb", Unit::DegreeCelsius, 50.0),
        ]),
        "p_ch",
    );
    let kelvin: f64 = 323.15;
    let choked = plant.plant().nozzle.choked_factor() * (gas.temperature_k / kelvin).sqrt();
    let per_mass = gas.gas_constant_j_per_kg_k * kelvin / plant.chamber.volume_m3;
    let supply = gas.supply_pressure_bar_gauge * 1e5 + 8e4;
    let seconds = (ROWS - 1) as f64 * STEP_S;
    let expected_bar = per_mass * choked * area * supply * seconds / 1e5;
    assert!(
        (found / expected_bar - 1.0).abs() < 1e-6,
        "{found} {expected_bar}"
    );
}

/// Coil at 80 °C: U / (R (1 + α 60 K)), equation 5.7.
#[test]
fn a_coil_begins_with_the_resistance_of_its_temperature() {
    let mut plant = PlantParameters::nominal();
    plant.coil.resistance_temperature_coefficient_per_k = 0.0039;
    let found = last(
        &plant,
        &log(&[
            ("duty_fill", Unit::Percent, 100.0),
            ("duty_vent", Unit::Percent, 0.0),
            ("t_coil", Unit::DegreeCelsius, 80.0),
        ]),
        "i_fill",
    );
    let resistance = plant.coil.resistance_20c_ohm * (1.0 + 0.0039 * 60.0);
    let expected = plant.ecu.supply_voltage_v / resistance * 1e3;
    assert!((found - expected).abs() < 0.01, "{found} {expected}");
}

#[test]
fn surroundings_that_cannot_be_say_where_and_what_to_do() {
    let mut plant = PlantParameters::nominal();
    plant.coil.resistance_temperature_coefficient_per_k = 0.0;
    let refused = |signal: (&str, Unit, f64)| {
        let error: ReplayError = Surroundings::of(&plant, &log(&[signal])).unwrap_err();
        error.to_string()
    };
    let gauge = refused(("p_amb", Unit::BarGauge, 0.0));
    assert!(
        gauge.contains("bench.csv") && gauge.contains("absolute"),
        "{gauge}"
    );
    let thin = refused(("p_amb", Unit::BarAbsolute, 0.1));
    for part in ["bench.csv", "p_amb", "10000", "30000", "constant"] {
        assert!(thin.contains(part), "{thin}");
    }
    let coil = refused(("t_coil", Unit::DegreeCelsius, 40.0));
    assert!(
        coil.contains("resistance_temperature_coefficient"),
        "{coil}"
    );
    // An omitted part has no surroundings.
    let mut coil_alone = PlantParameters::nominal();
    coil_alone.chamber.volume_m3 = 0.0;
    let found = Surroundings::of(&coil_alone, &log(&[("p_amb", Unit::BarAbsolute, 0.9)]));
    assert_eq!(found.unwrap(), Surroundings::default());
}
