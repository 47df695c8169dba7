//! Model driven by the commands of a log.

use plant_sim::plant::VENT;
use plant_sim::replay::{CurrentSampling, LONGEST_GAP_S, ReplayError, replay, unknown_signals};
use plant_sim::valve::ValveFunction;
use plant_sim::{Command, PlantParameters, Simulator, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

/// Returns a log with one row every `step_s`.
fn log(step_s: f64, signals: &[(&str, Unit, Vec<f64>)]) -> Recording {
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = TimeBase::uniform(0.0, step_s, signals[0].2.len()).unwrap();
    let base = log.add_time_base(base);
    for (name, unit, samples) in signals {
        log.add_signal(*name, *unit, base, samples.clone()).unwrap();
    }
    log
}

/// Returns a log with a vent valve that is not commanded, if `signals` has no command of it.
fn vent_shut(step_s: f64, signals: &[(&str, Unit, Vec<f64>)]) -> Recording {
    let shut = ("duty_vent", Unit::Percent, vec![0.0; signals[0].2.len()]);
    log(step_s, &[signals, &[shut]].concat())
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
    let whole = run(&nominal, &vent_shut(0.01, &[fill(duty.clone())]));
    duty[10] = f64::NAN;
    duty[11] = f64::NAN;
    let gappy = run(&nominal, &vent_shut(0.01, &[fill(duty)]));
    assert_eq!((whole.held_commands, gappy.held_commands), (0, 2));
    assert_eq!(
        last(&whole.recording, "p_ch"),
        last(&gappy.recording, "p_ch")
    );
}

#[test]
fn the_logged_supply_voltage_drives_the_coils() {
    let nominal = PlantParameters::nominal();
    let log = vent_shut(
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
    let scope = run(&nominal, &vent_shut(50e-6, &[fill(vec![100.0; 800])]));
    let ecu = run(&nominal, &vent_shut(0.01, &[fill(vec![100.0; 5])]));
    assert_eq!(scope.sampling, CurrentSampling::Instant);
    assert_eq!(ecu.sampling, CurrentSampling::MeanOfInterval);
    // 25 ms after the current began, the scope shows more than the mean of the last 10 ms.
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
    let log = vent_shut(0.01, &[fill(vec![100.0; 200])]);
    let (plain, staged) = (run(&PlantParameters::nominal(), &log), run(&with, &log));
    assert!(plain.recording.signal("x_plunger").is_none());
    assert!(
        (last(&staged.recording, "x_plunger") - 15.0).abs() < 1e-9,
        "at its stop, mm"
    );
    // The plunger does not change the chamber pressure (section 3.4).
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
    for name in ["duty_fill", "duty_vent"] {
        log.add_signal(name, Unit::Percent, base, vec![0.0; 3])
            .unwrap();
    }
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

/// Returns the nominal plant with omitted parts: without the lines that begin with one of the keys, and without the
/// tables.
fn without(keys: &[&str], valves: &str) -> PlantParameters {
    let is_left = |line: &&str| !keys.iter().any(|key| line.starts_with(key));
    let text = plant_sim::parameters::NOMINAL_PLANT_TOML;
    let text: Vec<_> = text.lines().filter(is_left).collect();
    let text = format!("{}\n[valves]\n{valves}\n", text.join("\n"));
    PlantParameters::from_toml(&text, "rig.toml").unwrap_or_else(|error| panic!("{error}"))
}

const FILL_KEYS: [&str; 4] = [
    "orifice_fill",
    "discharge_fill",
    "preload_fill",
    "supply_pressure",
];
const COIL_KEYS: [&str; 23] = [
    "[ecu]",
    "sample_time",
    "pwm",
    "command_delay",
    "supply_voltage",
    "free_wheel",
    "[coil]",
    "resistance",
    "inductance",
    "[magnet]",
    "force",
    "gap",
    "[armature]",
    "mass",
    "stroke",
    "viscous",
    "spring",
    "pressure_force",
    "preload",
    "orifice_fill",
    "discharge_fill",
    "supply_pressure",
    "no key",
];

fn pressure(samples: Vec<f64>) -> (&'static str, Unit, Vec<f64>) {
    ("p_ch", Unit::BarAbsolute, samples)
}

/// An orifice that is always open equals the open vent valve: compared with the nominal plant at 100 %, as soon as its
/// vent valve is open.
#[test]
fn a_vessel_blows_down_through_an_orifice_as_through_an_open_valve() {
    let vessel = without(&COIL_KEYS, "fill = \"absent\"\nvent = \"always_open\"");
    let log = log(0.01, &[pressure(vec![7.0; 30])]);
    let blown = run(&vessel, &log).recording;
    let names: Vec<_> = blown.signals().iter().map(|signal| signal.name()).collect();
    assert_eq!(names, ["p_ch", "t_gas"]);
    assert!((blown.signal("p_ch").unwrap().get(0).unwrap() - (7.0 - 1.01325)).abs() < 1e-9);

    let mut simulator = Simulator::new(&PlantParameters::nominal());
    simulator.command(Command {
        duty_fill_pct: 0.0,
        duty_vent_pct: 100.0,
    });
    simulator.advance_to_ns(100_000_000);
    simulator.set_chamber_pressure(7e5);
    simulator.advance_to_ns(100_000_000 + 290_000_000);
    let expected = (simulator.state().pressure - 101_325.0) / 1e5;
    let found = last(&blown, "p_ch");
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
}

#[test]
fn a_closed_chamber_keeps_the_first_logged_pressure() {
    let keys: Vec<_> = COIL_KEYS
        .iter()
        .chain(&["orifice_vent", "discharge_vent"])
        .copied()
        .collect();
    let chamber = without(&keys, "fill = \"absent\"\nvent = \"absent\"");
    let times = TimeBase::new(vec![0.0, 0.3, 60.0]).unwrap();
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = log.add_time_base(times);
    log.add_signal("p_ch", Unit::BarGauge, base, vec![f64::NAN, 5.0, 4.0])
        .unwrap();
    let kept = run(&chamber, &log).recording;
    assert_eq!(kept.signal("p_ch").unwrap().values_or_nan(), [5.0; 3]);
}

/// Equation 4.2 from a scope log; the coil has no other signals, and neither chamber nor gas.
#[test]
fn one_coil_takes_its_current_without_chamber_and_armature() {
    let keys = [
        "[magnet]",
        "force",
        "gap",
        "[armature]",
        "mass",
        "stroke",
        "viscous",
        "spring",
        "pressure_force",
        "preload",
        "inductance_open",
        "[flow]",
        "orifice",
        "discharge",
        "critical",
        "[gas]",
        "heat",
        "temperature_k",
        "supply_pressure",
        "ambient",
        "gas_constant",
        "[chamber]",
        "volume",
    ];
    let coil = without(&keys, "fill = \"blocked\"\nvent = \"absent\"");
    let log = log(50e-6, &[fill(vec![100.0; 800])]);
    let run = run(&coil, &log);
    let names: Vec<_> = run
        .recording
        .signals()
        .iter()
        .map(|signal| signal.name())
        .collect();
    assert_eq!(names, ["duty_fill", "i_fill", "u_bat"]);
    let seconds = 799.0 * 50e-6 - 0.015;
    let expected = 24.0 / 82.2 * 1e3 * (1.0 - (-seconds * 82.2 / 0.44_f64).exp());
    let found = last(&run.recording, "i_fill");
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
}

#[test]
fn a_command_to_a_coil_that_is_not_there_is_refused_and_zeros_are_not() {
    let plant = without(&FILL_KEYS, "fill = \"absent\"");
    let vent = || ("duty_vent", Unit::Percent, vec![50.0; 20]);
    assert!(
        run(&plant, &log(0.01, &[vent(), fill(vec![0.0; 20])]))
            .recording
            .signal("i_fill")
            .is_none()
    );
    let refused = replay(
        &plant,
        &log(0.01, &[vent(), fill(vec![50.0; 20])]),
        Tolerance::default(),
        |_, _| {},
    );
    let message = refused.unwrap_err().to_string();
    assert!(
        message.contains("`duty_fill` above 0 %, but the plant has no such valve"),
        "{message}"
    );
}

/// Defect seen: a misspelt column counted as 0 %, and a diagnosis found a cause for the error.
#[test]
fn a_command_that_is_not_there_is_no_zero_and_the_column_that_may_be_it_is_named() {
    let nominal = PlantParameters::nominal();
    let refused = |log: &Recording| {
        let refused = replay(&nominal, log, Tolerance::default(), |_, _| {});
        refused.unwrap_err().to_string()
    };
    let percent = |name: &'static str| (name, Unit::Percent, vec![50.0; 20]);
    let pressure = |name: &'static str| (name, Unit::BarGauge, vec![1.0; 20]);
    let misspelt = refused(&log(0.01, &[percent("duty_filll"), percent("duty_vent")]));
    for part in [
        "bench has no duty cycle `duty_fill`",
        "is it duty_filll?",
        "constant.duty_fill = { value = 0, unit = \"pct\" }",
    ] {
        assert!(misspelt.contains(part), "{misspelt}");
    }
    let other_name = refused(&log(0.01, &[percent("PWM2"), percent("duty_fill")]));
    assert!(
        other_name.contains("`duty_vent`") && other_name.contains("is it PWM2?"),
        "{other_name}"
    );
    let absent = refused(&log(0.01, &[fill(vec![50.0; 20]), pressure("p_ch")]));
    assert!(absent.contains("it has duty_fill, p_ch."), "{absent}");
    let empty = refused(&vent_shut(0.01, &[fill(vec![f64::NAN; 20])]));
    assert!(
        empty.contains("every sample of the duty cycle `duty_fill` is missing"),
        "{empty}"
    );
    let mut left_out = log(0.01, &[percent("duty_vent")]);
    left_out.leave_out("duty_fil", "a text channel");
    let left_out = refused(&left_out);
    assert!(
        left_out.contains("is it duty_fil (a text channel)?"),
        "{left_out}"
    );
}

#[test]
fn a_name_that_the_model_does_not_know_is_reported_with_what_it_may_be() {
    let nominal = PlantParameters::nominal();
    let nearest = |name: &'static str, unit: Unit, beside: &[(&str, Unit, Vec<f64>)]| {
        let log = log(0.01, &[beside, &[(name, unit, vec![1.0; 20])]].concat());
        let unknown = unknown_signals(&nominal, &log);
        let one = unknown.into_iter().find(|one| one.name == name);
        one.map_or(vec![], |one| one.nearest)
    };
    let pressure = [("p_ch", Unit::BarGauge, vec![1.0; 20])];
    assert_eq!(nearest("pressure", Unit::BarGauge, &[]), ["p_ch"]);
    assert_eq!(nearest("pressure", Unit::KilopascalAbsolute, &[]), ["p_ch"]);
    // A second pressure is not an unknown signal.
    assert_eq!(nearest("p_supply", Unit::BarGauge, &pressure), [""; 0]);
    assert_eq!(nearest("i_fil", Unit::Milliampere, &pressure), ["i_fill"]);
    assert_eq!(nearest("i_fil", Unit::Volt, &pressure), [""; 0]);
    assert_eq!(nearest("ambient", Unit::DegreeCelsius, &pressure), [""; 0]);
    assert_eq!(
        nearest("dc1", Unit::Percent, &pressure),
        ["duty_fill", "duty_vent"]
    );
}

/// Without a chamber the armature moves as between equal pressures; no data of an orifice is needed.
#[test]
fn a_valve_without_air_moves_to_its_stop() {
    let keys = [
        "pressure_force",
        "[flow]",
        "orifice",
        "discharge",
        "critical",
        "[gas]",
        "heat",
        "temperature_k",
        "supply_pressure",
        "ambient",
        "gas_constant",
        "[chamber]",
        "volume",
        "preload_vent",
    ];
    let valve = without(&keys, "fill = \"normally_closed\"\nvent = \"absent\"");
    let log = vent_shut(50e-6, &[fill(vec![100.0; 1600])]);
    let alone = run(&valve, &log).recording;
    assert_eq!(last(&alone, "x_fill"), 0.5);

    let mut nominal = PlantParameters::nominal();
    nominal.gas.supply_pressure_bar_gauge = 0.0;
    let beside = run(&nominal, &log).recording;
    for name in ["i_fill", "x_fill"] {
        let [alone, beside] = [&alone, &beside].map(|run| run.signal(name).unwrap());
        let apart = alone.iter().zip(beside.iter());
        let worst = apart.map(|(a, b)| (a.unwrap() - b.unwrap()).abs());
        assert!(worst.fold(0.0, f64::max) < 0.02, "{name}");
    }
}

#[test]
fn a_replay_begins_where_the_sensor_shows_the_first_pressure() {
    let mut vessel = without(&COIL_KEYS, "fill = \"absent\"\nvent = \"always_open\"");
    vessel
        .set("effects.sensor_offset.offset_bar", 0.2, "test")
        .unwrap();
    let log = log(0.01, &[pressure(vec![7.0; 3])]);
    let blown = run(&vessel, &log).recording;
    let first = blown.signal("p_ch").unwrap().get(0).unwrap();
    assert!((first - (7.0 - 1.01325)).abs() < 1e-9, "{first}");
    let plain = run(&vessel.without_effect("sensor_offset"), &log).recording;
    let fall = |recording: &Recording| {
        let values = recording.signal("p_ch").unwrap().values_or_nan();
        values[0] - values[2]
    };
    assert!(fall(&blown) < fall(&plain), "the chamber itself is at less");
}
