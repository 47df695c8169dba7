//! Several effects at once, and logs of ordinary loggers.

use core::ops::ControlFlow;

use plant_sim::PlantParameters;
use plant_sim::effects::{Effect, EffectSetting, by_id};
use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::Knowledge;
use recording::Recording;

use super::Diagnosis;
use super::diagnose_with;
use super::result::{Step, StepKind, Verdict};
use crate::bench::{Bench, logged, pressure_alone};
use crate::{CompareOptions, compare_under};

/// Returns a diagnosis with these effects as the library.
fn diagnosed(plant: &PlantParameters, library: &[&str], logs: &[Recording; 2]) -> Diagnosis {
    let library: Vec<&'static dyn Effect> = library.iter().map(|id| by_id(id).unwrap()).collect();
    let [fitted, check] = logs;
    let goes_on = |_| ControlFlow::Continue(());
    let fitted = core::slice::from_ref(fitted);
    let check = core::slice::from_ref(check);
    diagnose_with(&library, plant, fitted, check, &goes_on).unwrap()
}

/// Each of the three effects leaves a large error of the others: alone, its size is undetermined, and the supply line fits best in a wrong
/// form.
#[test]
fn three_effects_are_named_together() {
    let effects = [
        ("chamber_leak", ("area_m2", 1e-8)),
        ("supply_line_droop", ("restriction_area_m2", 1.8e-6)),
        ("eddy_currents", ("loop_resistance_ohm", 300.0)),
    ];
    let plant =
        effects
            .into_iter()
            .fold(PlantParameters::nominal(), |plant, (id, (key, value))| {
                plant.with_effect(EffectSetting::typical(by_id(id).unwrap()).with(key, value))
            });
    let logs = [1, 2].map(|seed| {
        Bench {
            plant: plant.clone(),
            seed,
            ..Bench::default()
        }
        .measure()
    });
    let library = [
        "chamber_leak",
        "supply_line_droop",
        "eddy_currents",
        "sensor_lag",
        "gas_temperature",
    ];
    let diagnosis = diagnosed(&PlantParameters::nominal(), &library, &logs);
    assert_eq!(diagnosis.verdict, Verdict::Found, "{}", diagnosis.sentence);
    let mut named = diagnosis.effects.clone();
    named.sort();
    assert_eq!(
        named,
        ["chamber_leak", "eddy_currents", "supply_line_droop"]
    );
}

/// Rows as far apart as the samples of the ECU show the clock only through the model. A clock that was found without the sensor's lag
/// absorbs it.
#[test]
fn a_sensor_lag_is_distinguished_from_the_clock_of_a_slow_logger() {
    let lag = EffectSetting::typical(by_id("sensor_lag").unwrap());
    let mut given = PlantParameters::nominal();
    // A delay that compensates for the lag, as a fit without the lag finds.
    given.ecu.command_delay_s += 4e-3;
    let stated = Knowledge::Range(7e-3, 23e-3);
    let plant = PlantParameters::nominal().with_effect(lag.with("time_constant_s", 0.01));
    given
        .knowledge
        .insert("ecu.command_delay_s".to_owned(), stated);
    let logs = [(7.9e-3, 1), (2.2e-3, 2)].map(|(phase_s, seed)| {
        let drift_ppm = 117.0;
        let log = logged(&plant, LoggerClock { phase_s, drift_ppm }, 0.01, seed);
        pressure_alone(&log)
    });
    let library = ["sensor_lag", "dead_volume", "chamber_leak"];
    let diagnosis = diagnosed(&given, &library, &logs);
    assert_eq!(diagnosis.verdict, Verdict::Found, "{}", diagnosis.sentence);
    assert_eq!(diagnosis.effects, ["sensor_lag"]);
    assert_eq!(diagnosis.clocks.len(), 2);
    let mut clocks = diagnosis.clocks.iter();
    assert!(clocks.all(|clock| !clock.statement.contains("currents")));
    // Defect seen: a report compared under the clock that it found itself, with three times the error of the diagnosis.
    let [_, check] = &logs;
    let [plain, refined] = diagnosis.plain_and_refined(&given);
    let fitted = &diagnosis.conditions[&check.provenance().source];
    let free_run_bar = |plant, conditions| {
        let compared = compare_under(
            plant,
            check,
            conditions,
            &CompareOptions::default(),
            &|_| true,
        );
        let signals = compared.unwrap().signals;
        let of_pressure = signals.iter().find(|signal| signal.name == "p_ch");
        of_pressure.unwrap().free_run.rms
    };
    let of_steps = |step: Option<&Step>| step.unwrap().free_run_check_rms["p_ch"];
    let steps = &diagnosis.error_steps;
    let refitted = (steps.iter()).find(|step| step.kind == StepKind::ParametersRefitted);
    for (rms_bar, of_step_bar) in [
        (free_run_bar(&plain, &fitted.plain), of_steps(refitted)),
        (
            free_run_bar(&refined, &fitted.refined),
            of_steps(steps.last()),
        ),
    ] {
        assert!(
            (rms_bar / of_step_bar - 1.0).abs() < 0.02,
            "{rms_bar} bar, {of_step_bar} bar"
        );
    }
}

/// Means over a row of 1.7 ms look like instantaneous values half a row earlier, and so does the jump of a current that eddy currents
/// cause. Without eddy currents, instantaneous values fit better, and with that choice no effect is found.
#[test]
fn eddy_currents_are_distinguished_from_currents_of_an_instant() {
    let eddy = EffectSetting::typical(by_id("eddy_currents").unwrap());
    let plant = PlantParameters::nominal().with_effect(eddy.with("loop_resistance_ohm", 320.0));
    let logs = [(8.9e-3, 1), (4.7e-3, 2)].map(|(phase_s, seed)| {
        let drift_ppm = -149.0;
        logged(&plant, LoggerClock { phase_s, drift_ppm }, 1.68e-3, seed)
    });
    let library = ["eddy_currents", "iron_saturation", "flyback_clamp"];
    let diagnosis = diagnosed(&PlantParameters::nominal(), &library, &logs);
    assert_eq!(diagnosis.verdict, Verdict::Found, "{}", diagnosis.sentence);
    assert_eq!(diagnosis.effects, ["eddy_currents"]);
    for clock in &diagnosis.clocks {
        let end = "currents are taken for means since the row before";
        assert!(clock.statement.ends_with(end), "{}", clock.statement);
    }
}
