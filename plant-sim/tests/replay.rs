//! The model driven by the commands of a log.

use plant_sim::plant::VENT;
use plant_sim::replay::{CurrentSampling, LONGEST_GAP_S, ReplayError, replay};
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Simulator, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

/// A log with one row every `step_s`.
fn log(step_s: f64, signals: &[(&str, Unit, Vec<f64>)]) -> Recording {
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = TimeBase::uniform(0.0, step_s, signals[0].2.len()).unwrap();
    let base = log.add_time_base(base);
    for (name, unit, samples) in signals {
        log.add_signal(*name, *unit, base, samples.clone()).unwrap();
    }
    log
}

fn fill(samples: Vec<f64>) -> (&'static str, Unit, Vec<f64>) {
    ("duty_fill", Unit::Percent, samples)
}

fn run(parameters: &PlantParameters, log: &Recording) -> plant_sim::replay::Replayed {
    replay(parameters, log, Tolerance::default(), |_, _| {}).unwrap()
}

fn last(recording: &Recording, name: &str) -> f64 {
    *recording
        .signal(name)
        .unwrap()
        .values_or_nan()
        .last()
        .unwrap()
}

#[test]
fn a_missing_command_holds_the_last_one_and_is_counted() {
    let nominal = PlantParameters::nominal();
    let mut duty = vec![60.0; 40];
    let whole = run(&nominal, &log(0.01, &[fill(duty.clone())]));
    duty[10] = f64::NAN;
    duty[11] = f64::NAN;
    let gappy = run(&nominal, &log(0.01, &[fill(duty)]));
    assert_eq!((whole.held_commands, gappy.held_commands), (0, 2));
    assert_eq!(
        last(&whole.recording, "p_ch"),
        last(&gappy.recording, "p_ch")
    );
}

#[test]
fn the_logged_supply_voltage_drives_the_coils() {
    let nominal = PlantParameters::nominal();
    let log = log(
        0.01,
        &[fill(vec![100.0; 60]), ("u_bat", Unit::Volt, vec![20.0; 60])],
    );
    let current = last(&run(&nominal, &log).recording, "i_fill");
    let expected = 20.0 / nominal.coil.resistance_20c_ohm * 1e3;
    assert!((current - expected).abs() < 0.01, "{current} {expected}");
}

#[test]
fn a_scope_sees_the_instant_and_an_ecu_the_mean() {
    let nominal = PlantParameters::nominal();
    let scope = run(&nominal, &log(50e-6, &[fill(vec![100.0; 800])]));
    let ecu = run(&nominal, &log(0.01, &[fill(vec![100.0; 5])]));
    assert_eq!(scope.sampling, CurrentSampling::Instant);
    assert_eq!(ecu.sampling, CurrentSampling::MeanOfInterval);
    // 25 ms after the current began: the scope shows more than the mean of the last 10 ms.
    assert!(last(&scope.recording, "i_fill") > last(&ecu.recording, "i_fill") + 1.0);
}

#[test]
fn the_regulating_valve_is_an_output_stage() {
    let text = format!(
        "{}\n[regulating_valve]\nplunger_mass_kg = 0.15\nair_area_m2 = 1.4e-3\noil_area_m2 = 0.0\n\
         oil_pressure_bar_gauge = 0.0\nspring_n_per_m = 42e3\npreload_n = 200\nstatic_friction_n = 12\n\
         dynamic_friction_n = 8\nstroke_m = 15e-3\n",
        plant_sim::parameters::NOMINAL_PLANT_TOML
    );
    let with = PlantParameters::from_toml(&text, "rig.toml").unwrap();
    let log = log(0.01, &[fill(vec![100.0; 200])]);
    let (plain, staged) = (run(&PlantParameters::nominal(), &log), run(&with, &log));
    assert!(plain.recording.signal("x_plunger").is_none());
    assert!(
        (last(&staged.recording, "x_plunger") - 15.0).abs() < 1e-9,
        "at its stop, mm"
    );
    // It does not act back (section 3.4).
    assert_eq!(
        last(&plain.recording, "p_ch"),
        last(&staged.recording, "p_ch")
    );
}

#[test]
fn a_gap_that_no_bench_log_has_is_refused() {
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = TimeBase::new(vec![0.0, 0.01, LONGEST_GAP_S + 1.0]).unwrap();
    let base = log.add_time_base(base);
    log.add_signal("duty_fill", Unit::Percent, base, vec![0.0; 3])
        .unwrap();
    let refused = replay(
        &PlantParameters::nominal(),
        &log,
        Tolerance::default(),
        |_, _| {},
    );
    assert!(matches!(refused, Err(ReplayError::Gap { .. })));
}

/// The whole trajectory, not only the integrator, converges with the tolerance; valves of both kinds.
#[test]
fn the_trajectory_converges_with_the_tolerance() {
    for function in [ValveFunction::NormallyClosed, ValveFunction::NormallyOpen] {
        let mut parameters = PlantParameters::nominal();
        parameters.functions[VENT] = function;
        let end = |factor: f64| {
            let mut simulator = Simulator::with_tolerance(&parameters, Tolerance::scaled(factor));
            for sample in 0..100_u64 {
                simulator.advance_to_ns(sample * 10_000_000);
                simulator.command(Command {
                    duty_fill_pct: 35.0 + (sample * 37 % 60) as f64,
                    duty_vent_pct: 30.0 + (sample * 23 % 60) as f64,
                });
            }
            simulator.state().pressure
        };
        let reference = end(1e-6);
        let error = |factor: f64| (end(factor) - reference).abs();
        assert!(error(1.0) < 100.0, "{function:?}: {} Pa", error(1.0));
        assert!(error(1e-2) < 10.0, "{function:?}: {} Pa", error(1e-2));
        assert!(error(1e-4) < 0.1, "{function:?}: {} Pa", error(1e-4));
    }
}
