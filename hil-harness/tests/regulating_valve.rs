//! The regulating valve as the output stage of the loop: position, stick-slip and rest positions of its plunger.

use hil_harness::{ReferenceProfile, Requirement, Run, Scenario, run_in_process};
use plant_sim::PlantParameters;
use plant_sim::parameters::{NOMINAL_PLANT_TOML, RegulatingValveParameters};
use recording::Unit;

/// Returns the nominal plant with a regulating valve whose plunger has this friction at rest and in motion (N).
fn plant(static_friction_n: f64, dynamic_friction_n: f64) -> PlantParameters {
    let text = format!(
        "{NOMINAL_PLANT_TOML}\n[regulating_valve]\nplunger_mass_kg = 0.15\nair_area_m2 = 1.4e-3\noil_area_m2 = 0\n\
         oil_pressure_bar_gauge = 0\nspring_n_per_m = 60e3\npreload_n = 100\nstatic_friction_n = {static_friction_n}\n\
         dynamic_friction_n = {dynamic_friction_n}\nstroke_m = 15e-3\n"
    );
    PlantParameters::from_toml(&text, "rig.toml").unwrap()
}

/// References that are reached from below and from above.
fn run(plant: PlantParameters) -> Run {
    let profile = [3.0, 5.0, 3.0, 1.5, 3.0, 5.5, 3.0]
        .into_iter()
        .fold(ReferenceProfile::starting_at(0.0), |profile, bar| {
            profile.step_to(bar).hold_ms(1500)
        });
    let scenario = Scenario {
        sensor_noise_mbar_rms: 0.0,
        ..Scenario::new("plunger", profile)
    };
    run_in_process(&scenario.on(plant)).unwrap()
}

fn values(run: &Run, name: &str, unit: Unit) -> Vec<f64> {
    run.recording.signal(name).unwrap().values_in(unit).unwrap()
}

/// Goal: a resting plunger is in balance within its friction (E15). Method: |A p - F_pld - k x| at the end of each step.
#[test]
fn the_plunger_rests_in_balance_within_its_friction() {
    let plant = plant(60.0, 40.0);
    let run = run(plant.clone());
    let RegulatingValveParameters {
        air_area_m2,
        spring_n_per_m,
        preload_n,
        stroke_m,
        ..
    } = plant.regulating_valve.unwrap();
    let position_mm = values(&run, "x_plunger", Unit::Millimetre);
    let pressure_bar = values(&run, "p_ch", Unit::BarGauge);
    let torque_pct = values(&run, "torque_proxy", Unit::Percent);
    for step in 1..=7 {
        let last = 150 * step - 1;
        let force = 1e5 * pressure_bar[last] * air_area_m2
            - preload_n
            - spring_n_per_m * 1e-3 * position_mm[last];
        assert!(force.abs() <= 60.0 + 0.1, "step {step}: {force} N");
        let share_pct = 0.1 * position_mm[last] / stroke_m;
        assert!((torque_pct[last] - share_pct).abs() < 1e-9);
    }
}

/// Friction lets the plunger rest at another place when the reference is reached from above; without friction it
/// follows the pressure. The pressure is the same with any valve: it does not act back (section 3.4).
#[test]
fn friction_separates_the_rest_positions_of_one_reference() {
    let verdict = |run: &Run| run.verdict(&Requirement::THESIS).unwrap();
    let [rough, smooth] = [plant(60.0, 40.0), plant(0.0, 0.0)].map(run);
    let plain = run(PlantParameters::nominal());
    let [with, without] = [&rough, &smooth].map(|run| verdict(run).plunger.unwrap());
    // At most twice the friction over the stiffness.
    assert!(
        with.rest_spread_mm > 0.3 && with.rest_spread_mm <= 2.0 + 0.1,
        "{with:?}"
    );
    assert!(with.starts_per_step >= 1.0, "{with:?}");
    assert!(with.rest_spread_mm > without.rest_spread_mm, "{without:?}");
    assert_eq!(verdict(&plain).plunger, None);
    assert!(plain.recording.signal("x_plunger").is_none());
    let [one, other] = [&rough, &smooth].map(|run| values(run, "p_ch", Unit::BarGauge));
    assert_eq!(one, other);
    let steps = |run: &Run| verdict(run).steps.len();
    assert_eq!(steps(&plain), steps(&rough));
}
