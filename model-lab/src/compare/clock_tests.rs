//! Logs whose rows are no samples of the ECU, and logs that begin with a filled chamber.

use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::Knowledge;
use recording::Recording;

use super::*;
use crate::bench::{Bench, logged, logged_through, pressure_alone, without_rows};
use crate::result::ClockSource;
use crate::{CompareOptions, compare, find_conditions};

const OFF_GRID: LoggerClock = LoggerClock {
    phase_s: 3.3e-3,
    drift_ppm: 50.0,
};

/// Returns the rms of the free-run simulation over the noise floor for each signal.
fn in_noise(comparison: &Comparison) -> Vec<f64> {
    let signals = comparison.signals.iter();
    signals
        .map(|signal| signal.free_run.rms_in_noise.unwrap())
        .collect()
}

/// Returns the plant of the logs as after a fit. In a first plant file, the delay may be as wrong as the clock.
pub(super) fn fitted() -> PlantParameters {
    let mut plant = PlantParameters::nominal();
    let delay = (
        "ecu.command_delay_s".to_owned(),
        Knowledge::Tolerance(0.5e-3),
    );
    plant.knowledge.extend([delay]);
    plant
}

fn compared(plant: &PlantParameters, log: &Recording) -> Comparison {
    compare(plant, log, &CompareOptions::default()).unwrap()
}

/// Compares as if the ECU itself had recorded the log from rest.
fn as_of_ecu(plant: &PlantParameters, log: &Recording) -> Comparison {
    let conditions = LogConditions::default();
    let options = CompareOptions::default();
    compare_under(plant, log, &conditions, &options, &|_| true).unwrap()
}

/// Goal: with the right plant the error is the noise, whatever the logger. The currents of a fast logger were wrong by a third of their
/// size.
#[test]
fn a_logger_with_a_clock_of_its_own_is_compared_at_its_noise() {
    let plant = fitted();
    let log = logged(&plant, OFF_GRID, 1e-3, 1);
    assert!(in_noise(&as_of_ecu(&plant, &log))[1] > 10.0);
    let comparison = compared(&plant, &log);
    let [p_ch, i_fill, i_vent] = in_noise(&comparison)[..] else {
        panic!("{:?}", comparison.signals);
    };
    assert!(
        p_ch < 1.2 && i_fill < 1.5 && i_vent < 1.5,
        "{p_ch} {i_fill} {i_vent}"
    );
    let clock = comparison.clock.unwrap();
    assert_eq!(clock.source, ClockSource::Commands);
    assert!(
        (clock.phase_s - OFF_GRID.phase_s).abs() < 0.3e-3,
        "{clock:?}"
    );
    assert!(
        (clock.drift_ppm - OFF_GRID.drift_ppm).abs() < 5.0,
        "{clock:?}"
    );

    let log = pressure_alone(&logged(&plant, OFF_GRID, 5e-3, 2));
    assert!(in_noise(&as_of_ecu(&plant, &log))[0] > 3.0);
    let comparison = compared(&plant, &log);
    assert!(
        in_noise(&comparison)[0] < 1.2,
        "{:?}",
        in_noise(&comparison)
    );
    // Rows 5 ms apart leave a drift open that moves the end of the log by milliseconds.
    let clock = comparison.clock.unwrap();
    let (least, most) = clock.admitted_drifts_ppm.unwrap();
    assert!(
        least < OFF_GRID.drift_ppm && OFF_GRID.drift_ppm < most,
        "{clock:?}"
    );
    assert!(
        clock.statement.contains("only a fitted plant narrows this"),
        "{clock:?}"
    );
}

/// Defect seen: in a log of 20 kHz, only the first two seconds determined the drift of the clock.
#[test]
fn all_of_a_fast_log_determines_the_drift() {
    let plant = fitted();
    let phases = Bench::default().phases.repeat(2);
    let log = logged_through(&plant, OFF_GRID, 50e-6, 3, &phases);
    let rows = log.time_bases().next().unwrap().1.len();
    assert!(rows > 400_000, "{rows}");
    let comparison = compared(&plant, &log);
    let drift_ppm = comparison.clock.as_ref().unwrap().drift_ppm;
    assert!((drift_ppm - OFF_GRID.drift_ppm).abs() < 2.0, "{drift_ppm}");
    let errors = in_noise(&comparison);
    assert!(errors.iter().all(|&error| error < 1.3), "{errors:?}");
}

/// A logger as slow as the ECU shows its clock only through the model.
#[test]
fn the_clock_of_a_slow_logger_is_found_with_the_model() {
    let plant = fitted();
    let log = logged(&plant, OFF_GRID, 10e-3, 3);
    assert!(in_noise(&as_of_ecu(&plant, &log))[1] > 5.0);
    let comparison = compared(&plant, &log);
    let errors = in_noise(&comparison);
    assert!(
        errors[0] < 1.2 && errors[1] < 1.5 && errors[2] < 1.5,
        "{errors:?}"
    );
    assert_eq!(comparison.clock.unwrap().source, ClockSource::Model);
}

/// Goal: a log of the ECU has no clock offset, however wrong the plant is. Otherwise the error of the plant would be taken for one.
#[test]
fn a_log_on_the_grid_of_the_ecu_is_compared_as_it_is() {
    let coarse = Bench::default();
    let fine = Bench {
        interval_s: 1e-3,
        ..Bench::default()
    };
    let leaking = Bench {
        leak_per_s: 1.0,
        ..Bench::default()
    };
    let charged = Bench {
        initial_bar: 3.0,
        ..Bench::default()
    };
    for bench in [coarse, fine, leaking, charged] {
        let log = bench.measure();
        for (key, factor) in [
            ("flow.discharge_fill", 1.0),
            ("flow.discharge_fill", 0.7),
            ("ecu.command_delay_s", 0.8),
            ("ecu.command_delay_s", 1.03),
            ("coil.resistance_20c_ohm", 1.1),
        ] {
            let mut plant = bench.plant.clone();
            let there = plant.get(key).unwrap();
            plant.set(key, factor * there, "test").unwrap();
            let conditions = find_conditions(&plant, &log);
            assert_eq!(
                conditions.clock("log"),
                None,
                "{key} {factor} at {} s",
                bench.interval_s
            );
            // No assert_eq: it would print both.
            assert!(
                compared(&plant, &log) == as_of_ecu(&plant, &log),
                "{key} {factor}"
            );
        }
    }
}

/// A log that begins while the fill valve is open: its coil has its full current at the first row.
#[test]
fn a_log_that_begins_with_a_filled_chamber_begins_under_its_first_command() {
    let plant = fitted();
    let whole = Bench::default().measure();
    let duty = whole.signal("duty_fill").unwrap().values_or_nan();
    let pressure = whole.signal("p_ch").unwrap().values_or_nan();
    let begin = (1..duty.len())
        .find(|&row| duty[row] == 100.0 && duty[row - 5] == 100.0 && pressure[row] > 1.0)
        .unwrap();
    let log = without_rows(&whole, 0..begin);
    let comparison = compared(&plant, &log);
    let errors = in_noise(&comparison);
    assert!(
        errors[0] < 1.2 && errors[1] < 1.5 && errors[2] < 1.5,
        "{errors:?}"
    );

    let clock = logged(&plant, OFF_GRID, 2e-3, 4);
    let duty = clock.signal("duty_fill").unwrap().values_or_nan();
    let pressure = clock.signal("p_ch").unwrap().values_or_nan();
    let begin = (25..duty.len())
        .find(|&row| duty[row] == 100.0 && duty[row - 25] == 100.0 && pressure[row] > 1.0)
        .unwrap();
    let comparison = compared(&plant, &without_rows(&clock, 0..begin));
    let errors = in_noise(&comparison);
    assert!(
        errors[0] < 1.2 && errors[1] < 1.5 && errors[2] < 1.5,
        "{errors:?}"
    );
}

/// A log that begins 7 ms after its first command was given. The current of the coil was wrong by 200 mA at its first pulse.
#[test]
fn the_first_command_of_a_log_was_given_before_its_first_row() {
    let plant = fitted();
    let whole = logged(&plant, OFF_GRID, 1e-3, 5);
    let duty = whole.signal("duty_fill").unwrap().values_or_nan();
    let given = (1..duty.len()).find(|&row| duty[row] > 0.0).unwrap();
    let errors = in_noise(&compared(&plant, &without_rows(&whole, 0..given + 7)));
    assert!(
        errors[0] < 1.2 && errors[1] < 1.5 && errors[2] < 1.5,
        "{errors:?}"
    );
}
