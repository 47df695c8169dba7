use core::ops::ControlFlow;
use std::sync::Mutex;

use plant_sim::PlantParameters;
use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::{Knowledge, LagOf};
use recording::Recording;

use super::*;
use crate::bench::{Bench, logged, logged_through, pressure_alone};
use crate::diagnosis::nuisance::ordinary_names;
use crate::diagnosis::search::Progress;

/// Returns a plant whose ordinary values differ from the nominal ones by up to a quarter, and whose coils differ by 6 %.
fn another_rig() -> PlantParameters {
    let mut plant = PlantParameters::nominal();
    plant.flow.discharge_fill *= 0.78;
    plant.flow.discharge_vent *= 1.12;
    plant.armature.preload_fill_n *= 0.9;
    plant.armature.preload_vent_n *= 1.08;
    plant.armature.spring_n_per_m *= 1.1;
    plant.coil.resistance_20c_ohm *= 1.06;
    plant.coil.inductance_closed_h *= 0.9;
    plant.coil.inductance_open_h *= 0.93;
    plant.ecu.command_delay_s = 19e-3;
    plant.gas.supply_pressure_bar_gauge = 8.1;
    plant
}

pub(super) fn estimated(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
) -> EstimatedPlant {
    estimate(plant, logs, check, &|_| ControlFlow::Continue(())).unwrap()
}

fn parameter<'a>(estimated: &'a EstimatedPlant, name: &str) -> &'a EstimatedParameter {
    let mut parameters = estimated.estimation.parameters.iter();
    parameters.find(|parameter| parameter.name == name).unwrap()
}

/// Goal: a first plant file and an ordinary logger, with its own clock, lead to a model that leaves the noise, and determined parameters
/// are right. Method: a rig of the same simulator, so that only the fit can fail.
#[test]
fn a_plant_file_that_is_a_quarter_off_is_mended_through_a_logger_with_a_clock_of_its_own() {
    let rig = another_rig();
    let [fitted, check] =
        [(3.3e-3, 140.0, 1), (8.1e-3, 140.0, 2)].map(|(phase_s, drift_ppm, seed)| {
            logged(&rig, LoggerClock { phase_s, drift_ppm }, 2e-3, seed)
        });
    let errors = Mutex::new(Vec::new());
    let watch = |seen: Progress| {
        errors.lock().unwrap().extend(seen.error);
        ControlFlow::Continue(())
    };
    let found = estimate(&PlantParameters::nominal(), &[fitted], &[check], &watch).unwrap();
    let estimation = &found.estimation;
    assert!(estimation.is_adequate, "{}", estimation.sentence);
    let errors = errors.into_inner().unwrap();
    let (first, last) = (errors[0].floors, errors[errors.len() - 1].floors);
    assert!(errors.len() > 5 && first > 5.0 && last < 1.1, "{errors:?}");
    correlations_are_those_of_the_parameters(estimation);
    let [given, after] = &estimation.steps[..] else {
        panic!("{:?}", estimation.steps)
    };
    assert!(given.worst_in_noise() > 5.0, "{:?}", given);
    assert!(after.worst_in_noise() < 1.1, "{:?}", after);
    for (clock, phase_s) in estimation.clocks.iter().zip([3.3e-3, 8.1e-3]) {
        assert!((clock.drift_ppm - 140.0).abs() < 10.0, "{clock:?}");
        // Commands that change with the rows determine the phase only within a row.
        assert!((clock.phase_s - phase_s).abs() < 2e-3, "{clock:?}");
    }
    assert_eq!(estimation.clocks.len(), 2);
    let mut determined = 0;
    for parameter in &estimation.parameters {
        let truth = rig.get(&parameter.name).unwrap();
        if parameter.determination == Determination::Determined {
            determined += 1;
            let width = parameter.high - parameter.low;
            assert!(
                truth > parameter.low - 0.5 * width && truth < parameter.high + 0.5 * width,
                "{truth}: {parameter:?}"
            );
        }
    }
    assert!(determined >= 6, "{:?}", estimation.parameters);
    // Pressures alone determine the ratio of flow and volume.
    let volume = parameter(&found, "chamber.volume_m3");
    let Determination::OnlyTogetherWith { parameters } = &volume.determination else {
        panic!("{volume:?}")
    };
    assert!(
        parameters.iter().any(|name| name == "flow.discharge_fill"),
        "{parameters:?}"
    );
    assert!(volume.determined_by.is_some());
    // The refined file is a plant file that states how well each value is known.
    let read = PlantParameters::from_toml(&found.plant.to_toml(), "refined").unwrap();
    let resistance = read.knowledge["coil.resistance_20c_ohm"];
    assert!(
        matches!(resistance, Knowledge::TolerancePct(percent) if percent < 2.0),
        "{resistance:?}"
    );
}

/// Checks the correlation matrix of `estimation`, in which flow and volume go together, and the ranges of its parameters.
fn correlations_are_those_of_the_parameters(estimation: &Estimation) {
    let (parameters, rows) = (&estimation.parameters, &estimation.correlations);
    assert_eq!(rows.len(), parameters.len());
    for (n, row) in rows.iter().enumerate() {
        assert_eq!((row.len(), row[n]), (rows.len(), 1.0));
        for (m, &value) in row.iter().enumerate() {
            assert!(
                value.abs() <= 1.0 && value == rows[m][n],
                "{n} {m}: {value}"
            );
        }
    }
    let place = |name: &str| parameters.iter().position(|one| one.name == name).unwrap();
    let together = rows[place("chamber.volume_m3")][place("flow.discharge_fill")];
    assert!(together > 0.9, "{together}");
    for one in parameters {
        let [least, most] = one.within.unwrap();
        assert!(least <= one.after && one.after <= most, "{one:?}");
    }
}

/// Defect seen: with a slow logger, a delay and a clock that are both later leave the same errors. The fit moved to the delay of the plant
/// file, and the commands of the validation log then were between other rows.
#[test]
fn rows_and_commands_of_a_slow_logger_show_the_delay() {
    let mut rig = PlantParameters::nominal();
    rig.ecu.command_delay_s = 12.3e-3;
    rig.flow.discharge_fill *= 0.9;
    let mut given = PlantParameters::nominal();
    for name in ordinary_names() {
        given.knowledge.insert(name.to_owned(), Knowledge::Exact);
    }
    let free = [("ecu.command_delay_s", 8e-3), ("flow.discharge_fill", 0.3)];
    for (name, half) in free {
        let stated = Knowledge::Tolerance(half);
        given.knowledge.insert(name.to_owned(), stated);
    }
    let pulses = [
        (0.07, 70.0, 0.0),
        (0.41, 0.0, 0.0),
        (0.09, 0.0, 70.0),
        (0.43, 0.0, 0.0),
    ];
    let pulses: Vec<_> = pulses.into_iter().cycle().take(120).collect();
    let logs = [(0.4e-3, 1), (6.2e-3, 2)].map(|(phase_s, seed)| {
        let drift_ppm = 70.0;
        let clock = LoggerClock { phase_s, drift_ppm };
        pressure_alone(&logged_through(&rig, clock, 27e-3, seed, &pulses))
    });
    let [fitted, check] = logs;
    let found = estimated(&given, &[fitted], &[check]);
    let delay = parameter(&found, "ecu.command_delay_s");
    assert!((delay.after - 12.3e-3).abs() < 0.6e-3, "{delay:?}");
    let after = found.estimation.steps.last().unwrap();
    assert!(after.worst_in_noise() < 1.2, "{:?}", after);
}

/// Defect seen: pressures determined a resistance to 0.3 %, 9 % from the true one: a coil with larger resistance, inductances and force
/// constant moves the armature alike.
#[test]
fn pressures_alone_show_the_values_of_a_coil_together() {
    let mut given = PlantParameters::nominal();
    for name in ordinary_names() {
        given.knowledge.insert(name.to_owned(), Knowledge::Exact);
    }
    let of_coil = [
        "coil.resistance_20c_ohm",
        "coil.inductance_closed_h",
        "coil.inductance_open_h",
        "magnet.force_constant_n_m2_per_a2",
    ];
    for name in of_coil {
        let stated = Knowledge::TolerancePct(30.0);
        given.knowledge.insert(name.to_owned(), stated);
    }
    let log = logged(&given, LoggerClock::default(), 1e-3, 1);
    let found = estimated(&given, &[pressure_alone(&log)], &[]);
    for name in of_coil {
        let Determination::OnlyTogetherWith { parameters } = &parameter(&found, name).determination
        else {
            panic!("{:?}", parameter(&found, name))
        };
        assert!(
            parameters.iter().all(|other| of_coil.contains(&&**other)),
            "{parameters:?}"
        );
    }
    let with_currents = estimated(&given, &[log], &[]);
    let resistance = parameter(&with_currents, of_coil[0]);
    assert_eq!(resistance.determination, Determination::Determined);
}

/// Defect seen: a plant file with every value fixed and a log of the ECU itself left nothing to fit, and the estimation panicked.
#[test]
fn where_every_parameter_is_fixed_nothing_is_estimated() {
    let mut plant = PlantParameters::nominal();
    for name in ordinary_names() {
        plant.knowledge.insert(name.to_owned(), Knowledge::Exact);
    }
    let found = estimated(&plant, &[Bench::default().measure()], &[]).estimation;
    assert!(found.is_adequate && found.parameters.is_empty());
    assert!(
        found
            .sentence
            .ends_with("nothing was estimated, since every parameter is fixed"),
        "{}",
        found.sentence
    );
}

#[test]
fn a_log_of_the_ecu_itself_has_no_clock_of_its_own_and_what_is_fixed_stays() {
    let mut plant = PlantParameters::nominal();
    for name in ["chamber.volume_m3", "coil.resistance_20c_ohm"] {
        plant.knowledge.insert(name.to_owned(), Knowledge::Exact);
    }
    let stated = Knowledge::Range(3.0, 3.2);
    plant
        .knowledge
        .insert("armature.preload_fill_n".to_owned(), stated);
    let log = Bench::default().measure();
    let found = estimated(&plant, &[log], &[]);
    assert!(
        found.estimation.clocks.is_empty(),
        "{:?}",
        found.estimation.clocks
    );
    let names = found
        .estimation
        .parameters
        .iter()
        .map(|parameter| &*parameter.name);
    assert!(!names.clone().any(|name| name == "chamber.volume_m3"));
    assert_eq!(
        found.plant.coil.resistance_20c_ohm,
        plant.coil.resistance_20c_ohm
    );
    // The rig has 3.58 N.
    let preload = parameter(&found, "armature.preload_fill_n");
    assert_eq!(preload.determination, Determination::AtLimit);
    assert!(preload.after <= 3.2, "{preload:?}");
}

/// Defect seen: "physics is missing" was reported for a rig without an effect, because the validation log vented, which the training log
/// did not.
#[test]
fn a_check_log_that_needs_what_the_fitted_one_leaves_open_is_no_missing_physics() {
    let fills = [
        (0.5, 0.0, 0.0),
        (0.1, 60.0, 0.0),
        (0.5, 0.0, 0.0),
        (0.15, 45.0, 0.0),
    ]
    .repeat(4);
    let rig = another_rig();
    let fitted = Bench {
        plant: rig.clone(),
        phases: fills,
        ..Bench::default()
    };
    let check = Bench {
        plant: rig,
        seed: 2,
        ..Bench::default()
    };
    let found = estimated(
        &PlantParameters::nominal(),
        &[fitted.measure()],
        &[check.measure()],
    );
    let estimation = &found.estimation;
    assert!(estimation.explains_fitted_logs && !estimation.is_adequate);
    assert!(
        !estimation.sentence.contains("physics is missing"),
        "{}",
        estimation.sentence
    );
    let all = [fitted.measure(), check.measure()];
    let found = estimated(&PlantParameters::nominal(), &all, &[]);
    assert!(
        found.estimation.is_adequate,
        "{}",
        found.estimation.sentence
    );
}

/// Defect seen: 1.13 noise floors on a rig without an effect, whose converter had 8 bits, were called missing physics.
#[test]
fn a_little_more_than_the_noise_says_nothing_of_physics() {
    let said = |left: Left| result::sentence(left, true, &[]);
    assert_eq!(
        said(Left::Little(1.13)),
        "the estimated model leaves 1.13 times the noise: too little to say whether physics is missing; nothing was estimated, since every parameter is fixed"
    );
    assert!(said(Left::More).contains("so physics is missing"));
}

/// Asserts that an estimation leaves the noise, and that the values of `rig` lie in its intervals.
#[track_caller]
fn assert_is_estimated(estimation: &Estimation, rig: &PlantParameters) {
    assert!(estimation.is_adequate, "{}", estimation.sentence);
    let last = estimation.steps.last().unwrap();
    assert!(last.worst_in_noise() < 1.1, "{last:?}");
    assert!(last.worst_free_run_in_noise() < 1.5, "{last:?}");
    for parameter in &estimation.parameters {
        let truth = rig.get(&parameter.name).unwrap();
        let margin = 0.1 * (parameter.high - parameter.low) + 1e-9 * truth.abs();
        assert!(
            truth > parameter.low - margin && truth < parameter.high + margin,
            "{truth}: {parameter:?}"
        );
    }
}

/// Goal: a rig of on/off valves without coils, known from data sheets, leads to a model that leaves the noise, and the true values lie in
/// the intervals. Method: a rig of the same simulator at 50 Hz, with pressures alone, seen by a logger with a clock of its own.
#[test]
fn on_off_valves_known_from_data_sheets_are_estimated() {
    let sheet = PlantParameters::from_datasheet(ON_OFF, "data sheet").unwrap();
    let mut rig = sheet.clone();
    for (name, factor) in [
        ("chamber.volume_m3", 1.06),
        ("on_off_fill.conductance_dm3_per_s_bar", 1.1),
        ("on_off_fill.critical_ratio", 1.3),
        ("on_off_fill.opening_delay_s", 0.86),
        ("on_off_fill.closing_ramp_s", 1.3),
        ("on_off_vent.conductance_dm3_per_s_bar", 0.92),
        ("on_off_vent.opening_delay_s", 1.12),
        ("on_off_vent.closing_delay_s", 0.83),
        ("gas.supply_pressure_bar_gauge", 0.98),
    ] {
        let value = sheet.get(name).unwrap() * factor;
        rig.set(name, value, "truth").unwrap();
    }
    let phases: Vec<(f64, f64, f64)> = Bench::default().phases.repeat(2);
    let [fitted, check] = [(4e-3, 1), (7e-3, 2)].map(|(phase_s, seed)| {
        let clock = LoggerClock {
            phase_s,
            drift_ppm: 60.0,
        };
        pressure_alone(&logged_through(&rig, clock, 10e-3, seed, &phases))
    });
    let found = estimated(&sheet, &[fitted], &[check]);
    assert_is_estimated(&found.estimation, &rig);
}

/// Goal and method as for on/off valves, with steps of the command.
#[test]
fn proportional_valves_known_from_data_sheets_are_estimated() {
    let sheet = PlantParameters::from_datasheet(PROPORTIONAL, "data sheet").unwrap();
    let rig = proportional_rig(&sheet, None);
    let [fitted, check] = [1, 2].map(|seed| proportional_log(&rig, seed));
    let found = estimated(&sheet, &[fitted], &[check]);
    assert_is_estimated(&found.estimation, &rig);
}

/// Defect seen: the opening of the model lagged where the spool of the rig did. Errors of 25 noise floors remained, and an effect was searched
/// for ten minutes.
#[test]
fn the_part_of_a_valve_that_lags_is_found_in_the_log() {
    let sheet = PlantParameters::from_datasheet(PROPORTIONAL, "data sheet").unwrap();
    for lag_of in [LagOf::Spool, LagOf::Opening] {
        let rig = proportional_rig(&sheet, Some(lag_of));
        let log = proportional_log(&rig, 1);
        let watch = |_| ControlFlow::Continue(());
        let found = lag_of_logs(&sheet, std::slice::from_ref(&log), &[], &watch).unwrap();
        assert_eq!(found, Some(lag_of));
        let stated = lag_of_logs(&rig, &[log], &[], &watch).unwrap();
        assert_eq!(stated, None, "the plant file states it");
    }
}

/// Returns a rig with other values than its data sheet.
fn proportional_rig(sheet: &PlantParameters, lag_of: Option<LagOf>) -> PlantParameters {
    let mut rig = sheet.with_lag_of(lag_of);
    for (name, value) in [
        ("chamber.volume_m3", 440e-6),
        ("proportional_fill.conductance_dm3_per_s_bar", 0.7),
        ("proportional_fill.time_constant_s", 0.023),
        ("proportional_fill.opens_at_pct", 17.0),
        ("proportional_fill.above_line_50_pct", -6.0),
        ("proportional_vent.time_constant_s", 0.016),
        ("proportional_vent.opens_at_pct", 13.5),
        ("ecu.command_delay_s", 9e-3),
    ] {
        rig.set(name, value, "truth").unwrap();
    }
    rig
}

fn proportional_log(rig: &PlantParameters, seed: u64) -> Recording {
    let steps = [20.0, 35.0, 50.0, 70.0, 100.0, 28.0, 60.0, 85.0];
    let phases: Vec<_> = steps
        .into_iter()
        .flat_map(|pct| {
            [
                (0.3, pct, 0.0),
                (0.4, 0.0, 0.0),
                (0.3, 0.0, 105.0 - 0.8 * pct),
                (0.5, 0.0, 0.0),
            ]
        })
        .cycle()
        .take(64)
        .collect();
    let clock = LoggerClock::default();
    pressure_alone(&logged_through(rig, clock, 5e-3, seed, &phases))
}

/// Defect seen: pulses of 1.76 and 1.80 ms lay around a delay, on one side of which the fit stayed: 81 % of the error was explained by the
/// effect that explains all of it.
#[test]
fn a_delay_is_found_across_the_lengths_of_pulses() {
    let sheet = PlantParameters::from_datasheet(ON_OFF, "data sheet").unwrap();
    let mut rig = sheet.clone();
    let name = "on_off_fill.opening_delay_s";
    rig.set(name, 7.1e-3, "truth").unwrap();
    // Pulses of 7.0 to 9.4 ms, each pressure by each pulse.
    let phases: Vec<_> = [35.0, 36.0, 38.0, 40.0, 43.0, 47.0]
        .into_iter()
        .flat_map(|duty_fill_pct| {
            [
                (0.4, duty_fill_pct, 0.0),
                (0.2, 0.0, 0.0),
                (0.2, 0.0, 100.0),
            ]
        })
        .collect();
    let clock = LoggerClock::default();
    let [fitted, check] = [1, 2]
        .map(|seed| pressure_alone(&logged_through(&rig, clock, 5e-3, seed, &phases.repeat(2))));
    let found = estimated(&sheet, &[fitted], &[check]);
    let delay = parameter(&found, name);
    assert!((delay.after - 7.1e-3).abs() < 0.1e-3, "{delay:?}");
    let last = found.estimation.steps.last().unwrap();
    assert!(last.worst_in_noise() < 1.1, "{last:?}");
}

const PROPORTIONAL: &str = "
    supply_pressure_bar_gauge = 7.15      # ±0.35
    temperature_c = 24.3
    command_frequency_hz = 100
    command_delay_ms = 8                  # ±25 %
    chamber_volume_cm3 = 419              # ±15 %
    fill_C_dm3_per_s_bar = 0.641          # ±15 %
    fill_b = 0.245                        # ±0.1
    fill_opens_at_pct = 15                # ±3
    fill_open_share_50_pct = 47           # ±6
    fill_time_constant_ms = 20            # ±25 %
    vent_C_dm3_per_s_bar = 1.02           # ±15 %
    vent_b = 0.382                        # ±0.1
    vent_opens_at_pct = 15                # ±3
    vent_time_constant_ms = 20            # ±25 %
";

const ON_OFF: &str = "
    supply_pressure_bar_gauge = 7.15      # ±0.35
    temperature_c = 24.3
    command_frequency_hz = 50
    chamber_volume_cm3 = 419              # ±15 %
    fill_C_dm3_per_s_bar = 0.641          # ±15 %
    fill_b = 0.245                        # ±0.1
    fill_opening_delay_ms = 8.77          # ±25 %
    fill_closing_delay_ms = 7.98          # ±25 %
    fill_opening_ramp_ms = 2.36           # ±25 % and ±1
    fill_closing_ramp_ms = 3.26           # ±25 % and ±1
    vent_C_dm3_per_s_bar = 1.02           # ±15 %
    vent_b = 0.382                        # ±0.1
    vent_opening_delay_ms = 9.73          # ±25 %
    vent_closing_delay_ms = 8.32          # ±25 %
    vent_opening_ramp_ms = 2.27           # ±25 % and ±1
    vent_closing_ramp_ms = 4.14           # ±25 % and ±1
";
