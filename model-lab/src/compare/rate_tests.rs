//! Logs with several rates: each signal is compared at its own instants.

use plant_sim::logger_clock::LoggerClock;

use super::clock_tests::fitted;
use super::*;
use crate::bench::{Rate, logged_at_rates, without_rows};
use crate::result::ClockSource;
use crate::{CompareOptions, compare};

const CLOCK: LoggerClock = LoggerClock {
    phase_s: 3.3e-3,
    drift_ppm: 50.0,
};

const DUTY_CYCLES: &[&str] = &["duty_fill", "duty_vent"];
const CURRENTS: &[&str] = &["i_fill", "i_vent"];

/// Returns the comparison of the true plant with a log of these rates, and the rms of each signal over its noise floor.
fn compared(rates: &[Rate]) -> (Comparison, Vec<(String, f64)>) {
    let plant = fitted();
    let log = logged_at_rates(&plant, CLOCK, rates);
    let comparison = compare(&plant, &log, &CompareOptions::default()).unwrap();
    let in_noise = |signal: &SignalComparison| {
        let error = signal.free_run.rms_in_noise.unwrap();
        (signal.name.clone(), error)
    };
    let errors = comparison.signals.iter().map(in_noise).collect();
    (comparison, errors)
}

fn assert_noise(errors: &[(String, f64)]) {
    assert_eq!(errors.len(), 3, "{errors:?}");
    assert!(errors.iter().all(|(_, error)| *error < 1.3), "{errors:?}");
}

/// Defect seen: "p_ch cannot be compared: it has another time base than what drives the model".
#[test]
fn a_fast_pressure_and_slow_commands_leave_the_noise() {
    for currents in [
        (CURRENTS, 0.01, 0.0),
        (CURRENTS, 0.01, 4e-3),
        (CURRENTS, 5e-3, 2e-3),
    ] {
        let pressure: Rate = (&["p_ch"], 1e-3, 0.0);
        let (comparison, errors) = compared(&[pressure, (DUTY_CYCLES, 0.01, 0.0), currents]);
        assert_noise(&errors);
        let traces = &comparison.traces;
        for signal in ["p_ch", "i_fill"] {
            let measured = traces.measured.time_base_of(signal).unwrap();
            assert_eq!(traces.free_run.time_base_of(signal).unwrap(), measured);
            let interval_s = if signal == "p_ch" { 1e-3 } else { currents.1 };
            let step_s = measured.sampling().median_step_s.unwrap();
            assert!(
                (step_s / interval_s - 1.0).abs() < 1e-6,
                "{signal} {step_s}"
            );
            let residual = traces.free_run_residual(signal).unwrap();
            assert_eq!(residual.len(), measured.len());
            let of_signal = traces.placements.iter().filter(|one| one.signal == signal);
            for placement in of_signal {
                assert_eq!(placement.bin_of.len(), measured.len());
            }
        }
    }
}

/// Commands of a millisecond logger determine its clock, whatever the rate of the other signals.
#[test]
fn fast_commands_determine_the_clock_of_slow_signals() {
    let (comparison, errors) = compared(&[
        (DUTY_CYCLES, 1e-3, 0.0),
        (&["p_ch"], 0.02, 7e-3),
        (CURRENTS, 0.01, 1e-3),
    ]);
    assert_noise(&errors);
    let clock = comparison.clock.unwrap();
    assert_eq!(clock.source, ClockSource::Commands);
    assert!((clock.phase_s - CLOCK.phase_s).abs() < 0.3e-3, "{clock:?}");
}

/// An oscilloscope on the coils beside the log of the ECU.
#[test]
fn currents_of_an_oscilloscope_are_compared_beside_a_slow_pressure() {
    let (_, errors) = compared(&[
        (CURRENTS, 0.1e-3, 0.0),
        (&["p_ch"], 0.01, 2e-3),
        (DUTY_CYCLES, 0.01, 2e-3),
    ]);
    assert_noise(&errors);
}

/// Each message of a bus has an instant of its own.
#[test]
fn signals_of_one_rate_at_other_instants_leave_the_noise() {
    let (_, errors) = compared(&[
        (&["duty_fill"], 0.01, 0.0),
        (&["duty_vent"], 0.01, 0.4e-3),
        (&["p_ch"], 0.01, 5e-3),
        (CURRENTS, 0.01, 8e-3),
    ]);
    assert_noise(&errors);
}

/// A file with one time column leaves the cells of a slow signal empty.
#[test]
fn empty_cells_between_the_samples_of_a_slow_signal_change_nothing() {
    let plant = fitted();
    let rates: [Rate; 2] = [
        (&["p_ch"], 1e-3, 0.0),
        (&["duty_fill", "duty_vent", "i_fill", "i_vent"], 0.01, 4e-3),
    ];
    let log = logged_at_rates(&plant, CLOCK, &rates);
    let united = united(&plant, &log);
    assert_eq!(
        united.signals()[1].time_base(),
        united.signals()[0].time_base()
    );
    let of = |log: &Recording| compare(&plant, log, &CompareOptions::default()).unwrap();
    let (own, empty) = (of(&log), of(&united));
    for (own, empty) in own.signals.iter().zip(&empty.signals) {
        assert_eq!(own.free_run, empty.free_run);
        assert_eq!(own.noise_floor, empty.noise_floor);
    }
    assert_eq!(own.clock, empty.clock);
}

/// Defect seen: after a gap the model went on with the last command, because the slow pressure has no sample in the row of the restart.
#[test]
fn the_model_begins_again_at_the_last_sample_of_a_slow_pressure() {
    let plant = fitted();
    for begin_s in [0.0, 1e-3, 2e-3, 3e-3] {
        let rates: [Rate; 2] = [
            (&["duty_fill", "duty_vent", "i_fill", "i_vent"], 1e-3, 0.0),
            (&["p_ch"], 5e-3, begin_s),
        ];
        let log = logged_at_rates(&plant, CLOCK, &rates);
        let united = united(&plant, &log).into_owned();
        let comparison = compare(
            &plant,
            &without_rows(&united, 5_000..8_000),
            &CompareOptions::default(),
        );
        let comparison = comparison.unwrap();
        let [gap] = &comparison.defects.gaps[..] else {
            panic!("{:?}", comparison.defects);
        };
        assert!(gap.restart_bar_gauge.is_some(), "{begin_s}: {gap:?}");
        let errors = comparison
            .signals
            .iter()
            .map(|signal| signal.free_run.rms_in_noise.unwrap());
        assert!(
            errors.clone().all(|error| error < 1.3),
            "{begin_s}: {:?}",
            errors.collect::<Vec<_>>()
        );
    }
}
