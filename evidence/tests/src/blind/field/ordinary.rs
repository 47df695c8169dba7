//! Ordinary parameters of a field rig, and the plant files with the first and with the true values.

use std::collections::BTreeMap;

use plant_sim::PlantParameters;

use crate::chance::Chance;
use crate::reference_plant::{Datasheet, Rig};

/// Bundled plant file: the first plant file of a user.
const NOMINAL: &str = include_str!("../../../../../data/nominal-plant.toml");
/// Addition to a user's file for a normally open vent valve.
const NORMALLY_OPEN: &str = "\n\n[valves]\nvent = \"normally_open\"\n";
/// Preload of the bundled file, and of a normally open vent valve of the same size, whose magnet works against the
/// pressure (N).
const PRELOADS_VENT: [&str; 2] = ["preload_vent_n = 3.34", "preload_vent_n = 1.40"];

/// Largest relative error of most parameters.
const FAR: f64 = 0.30;
/// Largest relative error of the inductances; both have the same error.
const INDUCTANCE: f64 = 0.15;
/// Largest relative error of the resistance.
const RESISTANCE: f64 = 0.10;
/// Largest error of the command delay (s).
const DELAY_S: f64 = 6e-3;
/// Largest error of the supply pressure (bar).
const SUPPLY_BAR: f64 = 0.5;

/// Minimum force of a magnet relative to the opposing force, so that the valve opens (closes, if normally open) at any
/// pressure.
const PULL_IN: f64 = 1.25;
/// Minimum of the same ratio at full stroke, where the magnet has to hold the armature.
const HOLD: f64 = 1.1;
/// Minimum force of the spring relative to the opposing force, so that the valve returns.
const FALL_BACK: f64 = 1.1;

/// Name of a drawn parameter and its field in a datasheet.
type Place = (&'static str, fn(&mut Datasheet) -> &mut f64);

/// Number of drawn parameters.
pub(super) const COUNT: usize = 13;

const PLACES: [Place; COUNT] = [
    ("flow.discharge_fill", |sheet| {
        &mut sheet.flow.discharge_fill
    }),
    ("flow.discharge_vent", |sheet| {
        &mut sheet.flow.discharge_vent
    }),
    ("armature.preload_fill_n", |sheet| {
        &mut sheet.armature.preload_fill_n
    }),
    ("armature.preload_vent_n", |sheet| {
        &mut sheet.armature.preload_vent_n
    }),
    ("armature.spring_n_per_m", |sheet| {
        &mut sheet.armature.spring_n_per_m
    }),
    ("armature.mass_kg", |sheet| &mut sheet.armature.mass_kg),
    ("magnet.force_constant_n_m2_per_a2", |sheet| {
        &mut sheet.magnet.force_constant_n_m2_per_a2
    }),
    ("chamber.volume_m3", |sheet| &mut sheet.chamber.volume_m3),
    ("coil.inductance_closed_h", |sheet| {
        &mut sheet.coil.inductance_closed_h
    }),
    ("coil.inductance_open_h", |sheet| {
        &mut sheet.coil.inductance_open_h
    }),
    ("coil.resistance_20c_ohm", |sheet| {
        &mut sheet.coil.resistance_20c_ohm
    }),
    ("ecu.command_delay_s", |sheet| {
        &mut sheet.ecu.command_delay_s
    }),
    ("gas.supply_pressure_bar_gauge", |sheet| {
        &mut sheet.gas.supply_pressure_bar_gauge
    }),
];

/// Returns the first plant file of a user.
pub(super) fn first_file(is_vent_normally_open: bool) -> String {
    if is_vent_normally_open {
        NOMINAL.replace(PRELOADS_VENT[0], PRELOADS_VENT[1]) + NORMALLY_OPEN
    } else {
        NOMINAL.to_owned()
    }
}

/// Returns the plant file with the true values, for the simulator.
pub(super) fn true_file(is_vent_normally_open: bool, parameters: &BTreeMap<String, f64>) -> String {
    let mut plant = PlantParameters::from_toml(&first_file(is_vent_normally_open), "first file")
        .expect("the bundled file is a plant file");
    for (name, value) in parameters {
        plant
            .set(name, *value, "true value")
            .expect("a drawn value is within the range of its parameter");
    }
    plant.to_toml()
}

/// Draws a rig whose valves open and close; other rigs would not be logged.
pub(super) fn rig(is_vent_normally_open: bool, chance: &mut Chance) -> Rig {
    let sheet: Datasheet = toml::from_str(&first_file(is_vent_normally_open))
        .expect("the bundled file is a datasheet");
    loop {
        let mut rig = Rig {
            datasheet: sheet.clone(),
            is_vent_normally_open,
            ..Rig::nominal()
        };
        scatter(&mut rig.datasheet, chance);
        if works(&rig) {
            return rig;
        }
    }
}

/// Returns the drawn values of a rig by their names in a plant file.
pub(super) fn parameters(rig: &Rig) -> BTreeMap<String, f64> {
    let mut sheet = rig.datasheet.clone();
    let named = PLACES.map(|(name, place)| (name.to_owned(), *place(&mut sheet)));
    named.into()
}

fn scatter(sheet: &mut Datasheet, chance: &mut Chance) {
    let inductance = chance.between(-1.0, 1.0);
    for (name, place) in PLACES {
        let value = place(sheet);
        let share = match name {
            "coil.inductance_closed_h" | "coil.inductance_open_h" => inductance,
            _ => chance.between(-1.0, 1.0),
        };
        *value += share * largest_error(name, *value);
    }
}

/// Returns the largest error of a parameter of this value, in its unit.
fn largest_error(name: &str, value: f64) -> f64 {
    match name {
        "coil.inductance_closed_h" | "coil.inductance_open_h" => INDUCTANCE * value,
        "coil.resistance_20c_ohm" => RESISTANCE * value,
        "ecu.command_delay_s" => DELAY_S,
        "gas.supply_pressure_bar_gauge" => SUPPLY_BAR,
        _ => FAR * value,
    }
}

/// Returns a rig whose drawn parameters differ from those of `rig` by these shares of their largest errors.
pub(super) fn moved(rig: &Rig, shares: &[f64; COUNT]) -> Rig {
    let mut moved = rig.clone();
    for ((name, place), share) in PLACES.into_iter().zip(shares) {
        let value = place(&mut moved.datasheet);
        *value += share * largest_error(name, *value);
    }
    moved
}

/// Returns whether both valves move to their stops and back at every pressure up to that of the supply.
fn works(rig: &Rig) -> bool {
    let sheet = &rig.datasheet;
    let armature = &sheet.armature;
    let current = sheet.ecu.supply_voltage_v / sheet.coil.resistance_20c_ohm;
    let pull = |gap: f64| sheet.magnet.force_constant_n_m2_per_a2 * (current / gap).powi(2);
    let gap = sheet.magnet.gap_closed_m;
    let pressure = std::f64::consts::FRAC_PI_4
        * armature.pressure_force_diameter_m.powi(2)
        * sheet.gas.supply_pressure_bar_gauge
        * 1e5;
    let spring = armature.spring_n_per_m * armature.stroke_m;
    let preloads = [armature.preload_fill_n, armature.preload_vent_n];
    preloads.into_iter().enumerate().all(|(valve, preload)| {
        let (against, back) = if valve == 1 && rig.is_vent_normally_open {
            (preload + pressure, preload)
        } else {
            (preload, preload - FALL_BACK * pressure)
        };
        pull(gap) >= PULL_IN * against
            && pull(gap - armature.stroke_m) >= HOLD * (against + spring)
            && back > 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_values_are_as_far_off_as_those_of_a_first_plant_file() {
        let mut chance = Chance::new(5);
        for n in 0..300 {
            let is_vent_normally_open = n % 3 == 0;
            let first = first_file(is_vent_normally_open);
            let first = PlantParameters::from_toml(&first, "first file").unwrap();
            for (name, value) in parameters(&rig(is_vent_normally_open, &mut chance)) {
                let before = first.get(&name).unwrap();
                let far = match name.as_str() {
                    "ecu.command_delay_s" => DELAY_S,
                    "gas.supply_pressure_bar_gauge" => SUPPLY_BAR,
                    "coil.resistance_20c_ohm" => RESISTANCE * before,
                    inductance if inductance.contains("inductance") => INDUCTANCE * before,
                    _ => FAR * before,
                };
                assert!((value - before).abs() <= far, "{name}: {before}, {value}");
            }
        }
    }

    #[test]
    fn the_true_file_has_the_true_values() {
        let rig = rig(true, &mut Chance::new(1));
        let truth = parameters(&rig);
        let plant = PlantParameters::from_toml(&true_file(true, &truth), "true file").unwrap();
        for (name, value) in &truth {
            assert!(
                (plant.get(name).unwrap() / value - 1.0).abs() < 1e-9,
                "{name}"
            );
        }
        let nominal = PlantParameters::from_toml(&true_file(false, &BTreeMap::new()), "").unwrap();
        assert_eq!(nominal.get("armature.preload_vent_n"), Some(3.34));
    }
}
