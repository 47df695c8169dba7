//! A user's own effects: a law in the plant file acts as the same law in the library, or as its closed form.

use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::{Command, PlantParameters, Simulator, Tolerance};

/// Returns the shipped plant with further tables.
fn with_tables(tables: &str) -> PlantParameters {
    let text = format!("{}\n{tables}", PlantParameters::nominal().to_toml());
    PlantParameters::from_toml(&text, "rig.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the shipped plant with an own effect of one parameter `k`, of value `k`; an empty unit is not stated.
fn with_law(acts_on: &str, expression: &str, unit: &str, k: f64) -> PlantParameters {
    let unit = match unit {
        "" => String::new(),
        unit => format!(", unit = \"{unit}\""),
    };
    with_tables(&format!(
        r#"
[own_effects.law]
sentence = "A law."
acts_on = "{acts_on}"
expression = "{expression}"
parameters.k = {{ typical = {k:e}, range = [0, {:e}]{unit} }}

[effects.own.law]
k = {k:e}
"#,
        2.5 * k
    ))
}

fn library(id: &str, variant: &str, values: &[(&str, f64)]) -> EffectSetting {
    let effect = by_id(id).unwrap();
    let variant = effect.about().variant(variant).unwrap();
    let typical = EffectSetting::typical_variant(effect, variant);
    values
        .iter()
        .fold(typical, |setting, (key, value)| setting.with(key, *value))
}

/// Returns shown pressure (Pa) and mean currents (A) every 10 ms under commands that fill, hold, pulse and vent.
fn traces(plant: &PlantParameters) -> Vec<[f64; 3]> {
    let mut simulator = Simulator::with_tolerance(plant, Tolerance::scaled(0.01));
    simulator.set_chamber_pressure(3e5);
    let duties = [
        (100.0, 0.0),
        (0.0, 0.0),
        (60.0, 0.0),
        (0.0, 55.0),
        (0.0, 100.0),
    ];
    (0..250_usize)
        .map(|row| {
            let (duty_fill_pct, duty_vent_pct) = duties[row / 50];
            simulator.advance_to_ns(row as u64 * 10_000_000);
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct,
            });
            let sample = simulator.sample();
            let [fill, vent] = sample.mean_current;
            [sample.measured_pressure, fill, vent]
        })
        .collect()
}

/// Checks that two plants have the same pressure within `pascal`, and the same currents within `ampere`.
fn assert_same(one: &PlantParameters, other: &PlantParameters, pascal: f64, ampere: f64) {
    for (row, (one, other)) in traces(one).iter().zip(traces(other)).enumerate() {
        let limits = [pascal, ampere, ampere];
        for ((one, other), limit) in one.iter().zip(other).zip(limits) {
            assert!((one - other).abs() <= limit, "row {row}: {one} {other}");
        }
    }
}

/// The library's laminar leak is κ (p² - p_a²), and κ follows from its flow at the supply pressure.
#[test]
fn an_own_leak_of_the_law_of_the_library_gives_the_same_pressure() {
    let nominal = PlantParameters::nominal();
    let leaking = nominal.with_effect(library("chamber_leak", "laminar", &[("area_m2", 5e-8)]));
    let plant = nominal.plant();
    let (high, low) = (plant.supply_pressure, plant.ambient_pressure);
    let kappa = plant.nozzle.mass_flow(5e-8, high, low) / (high * high - low * low);
    let own = with_law("leak_flow", "k * (p^2 - p_ambient^2)", "kg/s/Pa^2", kappa);
    assert_same(&own, &leaking, 20.0, 1e-5);
    // The leak is large enough to be seen.
    let [plain, own] = [&nominal, &own].map(|plant| traces(plant)[99][0]);
    assert!(plain - own > 5e3, "{plain} {own}");
}

#[test]
fn an_own_sensor_offset_is_that_of_the_library() {
    let offset = library("sensor_offset", "offset", &[("offset_bar", 0.08)]);
    let library = PlantParameters::nominal().with_effect(offset);
    let own = with_law("sensor_output", "k", "Pa", 8e3);
    assert_same(&own, &library, 20.0, 1e-5);
}

/// Copper that is 50 K warmer has 1 + 0.0039 · 50 times the resistance (equation 5.7 of the thesis).
#[test]
fn an_own_coil_resistance_is_that_of_a_warm_coil() {
    let warm = library(
        "coil_ambient_temperature",
        "uniform",
        &[("difference_k", 50.0)],
    );
    let library = PlantParameters::nominal().with_effect(warm);
    let own = with_law("coil_resistance", "1 + k", "1", 0.0039 * 50.0);
    assert_same(&own, &library, 60.0, 2e-4);
}

/// A factor of the volume that is constant is another volume; one of the area is another discharge coefficient.
#[test]
fn a_constant_factor_is_another_value_of_the_plant_file() {
    let mut larger = PlantParameters::nominal();
    larger.chamber.volume_m3 *= 1.25;
    let own = with_law("chamber_volume", "1 + k", "1", 0.25);
    assert_same(&own, &larger, 20.0, 1e-5);
    for (point, key) in [
        ("fill_area", "flow.discharge_fill"),
        ("vent_area", "flow.discharge_vent"),
    ] {
        let mut narrow = PlantParameters::nominal();
        let value = narrow.get(key).unwrap();
        narrow.set(key, 0.8 * value, "narrow").unwrap();
        let own = with_law(point, "1 - k", "1", 0.2);
        assert_same(&own, &narrow, 20.0, 1e-5);
    }
}

/// The growth of a hose: V = V₀ + G (p - p_a), the library's growth of the chamber (E65).
#[test]
fn a_volume_that_grows_with_the_pressure_is_that_of_the_chamber_table() {
    let mut hose = PlantParameters::nominal();
    let growth_m3_per_bar = 2e-6;
    hose.set("chamber.growth_m3_per_bar", growth_m3_per_bar, "hose")
        .unwrap();
    let per_pascal = growth_m3_per_bar / 1e5 / hose.chamber.volume_m3;
    let own = with_law(
        "chamber_volume",
        "1 + k * (p - p_ambient)",
        "1/Pa",
        per_pascal,
    );
    assert_same(&own, &hose, 30.0, 1e-5);
}

/// A shut chamber without leak keeps its mass, so that p V is constant: V grows by a tenth in a second.
#[test]
fn a_volume_that_grows_with_the_time_thins_the_gas() {
    let own = with_law("chamber_volume", "1 + k * time", "1/s", 0.1);
    let mut simulator = Simulator::with_tolerance(&own, Tolerance::scaled(0.01));
    simulator.set_chamber_pressure(5e5);
    for (seconds, expected) in [(1, 5e5 / 1.1), (3, 5e5 / 1.3)] {
        simulator.advance_to_ns(seconds * 1_000_000_000);
        let pressure = simulator.sample().pressure;
        assert!((pressure - expected).abs() < 5.0, "{pressure} {expected}");
    }
}

/// A constant force on an armature is a smaller preload, and a constant pressure is another supply.
#[test]
fn a_constant_force_is_a_smaller_preload_and_a_constant_pressure_another_supply() {
    for (point, preload) in [
        ("fill_force", "armature.preload_fill_n"),
        ("vent_force", "armature.preload_vent_n"),
    ] {
        let mut weak = PlantParameters::nominal();
        let value = weak.get(preload).unwrap();
        weak.set(preload, value - 0.3, "weak").unwrap();
        let own = with_law(point, "k", "N", 0.3);
        assert_same(&own, &weak, 100.0, 2e-4);
    }
    let mut higher = PlantParameters::nominal();
    higher.gas.supply_pressure_bar_gauge += 0.5;
    let own = with_law("supply_pressure", "k", "Pa", 5e4);
    assert_same(&own, &higher, 100.0, 2e-4);
}

/// Every variable reads its state: the sensor shows it in place of the pressure's error.
#[test]
fn each_variable_is_the_state_of_its_name() {
    let shown = |variable: &str, per: f64| {
        let own = with_law("sensor_output", &format!("k * {variable}"), "", per);
        let mut simulator = Simulator::new(&own);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 30.0,
        });
        simulator.advance_to_ns(200_000_000);
        let sample = simulator.sample();
        let state = *simulator.state();
        let value = (sample.measured_pressure - sample.pressure) / per;
        (value, sample, state)
    };
    let near = |variable: &str, per: f64, expected: &dyn Fn(&plant_sim::Sample) -> f64| {
        let (value, sample, _) = shown(variable, per);
        let expected = expected(&sample);
        let limit = 1e-6 * expected.abs() + 1e-6 / per;
        assert!(
            (value - expected).abs() < limit,
            "{variable}: {value} {expected}"
        );
    };
    let gas = PlantParameters::nominal().gas;
    near("p", 1e-2, &|sample| sample.pressure);
    near("p_supply", 1e-2, &|_| gas.supply_pressure_pa());
    near("p_ambient", 1e-2, &|_| gas.ambient_pressure_pa);
    near("time", 1e4, &|_| 0.2);
    near("t_gas", 1e2, &|_| gas.temperature_k);
    near("i_fill", 1e6, &|sample| sample.current[0]);
    near("i_vent", 1e6, &|sample| sample.current[1]);
    near("lift_fill", 1e8, &|sample| sample.position[0]);
    near("lift_vent", 1e8, &|sample| sample.position[1]);
    near("open_fill", 1e5, &|_| 1.0);
    near("duty_fill", 1e5, &|_| 1.0);
    near("duty_vent", 1e5, &|_| 0.3);
    let (value, _, state) = shown("velocity_vent", 1e6);
    assert!((value - state.valves[1].v).abs() < 1e-6, "{value}");
}

/// The law is possible in every range of the check, but not at the pressure that is reached here.
#[test]
fn a_law_that_leaves_its_bounds_aborts_the_simulation() {
    let mut own = with_law("vent_area", "1 - k * max(p - 2.1e6, 0)", "1/Pa", 1e-5);
    own.gas.supply_pressure_bar_gauge = 60.0;
    let mut simulator = Simulator::new(&own);
    simulator.command(Command {
        duty_fill_pct: 100.0,
        duty_vent_pct: 0.0,
    });
    simulator.advance_to_ns(5_000_000_000);
    assert!(simulator.is_aborted() && simulator.sample().pressure.is_nan());
}

/// Laws that no plant has, and that pass every check: they chatter, oscillate, jump, or drain the chamber to vacuum. A
/// simulation with a work limit ends, with a pressure or aborted.
#[test]
fn a_strange_law_ends_within_the_work_limit() {
    for (point, expression, k) in [
        ("leak_flow", "k", 1e-3),
        ("leak_flow", "-k", 1e-3),
        ("leak_flow", "k * sin(k * 1e12 * time)", 1e-3),
        ("leak_flow", "k * min(max(1e6 * (p - 4e5), -1), 1)", 1e-2),
        ("leak_flow", "k * max(p - p_ambient, 0) ^ 0.01", 1e-4),
        (
            "fill_force",
            "k * min(max(-1e9 * velocity_fill, -1), 1)",
            5.0,
        ),
        ("vent_force", "-k * 1e9 * velocity_vent", 1.0),
        ("chamber_volume", "1 + k * sin(k * 1e6 * time) ^ 2", 0.5),
        ("chamber_volume", "1 + k * tanh(k * (p - 4e5))", 0.02),
        ("supply_pressure", "-k", 2e6),
        ("supply_pressure", "k * sin(k * time) * open_fill", 1e5),
        ("coil_resistance", "1 + k * i_fill ^ 4 * 1e9", 1.0),
        ("vent_area", "1 + k * min(max(1e9 * (p - 4e5), 0), 1)", 5.0),
        (
            "sensor_output",
            "k * exp(duty_fill) * sin(k * 1e7 * time)",
            1e5,
        ),
    ] {
        let own = with_law(point, expression, "", k);
        let mut simulator = Simulator::new(&own);
        simulator.set_chamber_pressure(4e5);
        simulator.set_work_limit(200_000);
        for row in 1..=100 {
            simulator.command(Command {
                duty_fill_pct: 60.0,
                duty_vent_pct: (row % 3) as f64 * 30.0,
            });
            simulator.advance_to_ns(row * 10_000_000);
        }
        let pressure = simulator.sample().measured_pressure;
        let work = simulator.statistics().work();
        assert_eq!(simulator.is_aborted(), pressure.is_nan());
        assert!(point != "supply_pressure" || expression != "-k" || simulator.is_aborted());
        assert!(work <= 200_000 && (simulator.is_aborted() || pressure.is_finite()));
        // Air below vacuum is none: the pressure ends there, or the simulation does.
        assert!(
            simulator.is_aborted() || simulator.sample().pressure > 0.0,
            "{expression}: {pressure}"
        );
    }
}
