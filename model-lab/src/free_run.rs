//! One simulation of a log and the size of its error, for immediate feedback while a user changes a parameter.

use plant_sim::replay::{Surroundings, united};
use plant_sim::{PlantParameters, Tolerance};
use recording::Recording;

use crate::commands::Commands;
use crate::conditions::LogConditions;
use crate::error::CompareError;
use crate::measured::{LogAsRead, PRESSURE, measured_signals, start};
use crate::metrics::{residual, rms};
use crate::run::Setup;

/// Result of the model driven by the commands of a log alone.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRun {
    /// Signals of the model at the instants of the log.
    pub model: Recording,
    /// Size of the error for each signal that log and model have in common.
    pub errors: Vec<SignalError>,
}

/// Size of the error of the model in one signal.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalError {
    /// Name of the signal.
    pub name: &'static str,
    /// Unit of the error.
    pub unit: &'static str,
    /// Root mean square of measured minus modelled; none without samples.
    pub rms: Option<f64>,
    /// Standard deviation of the measurement noise; none where the log does not show it.
    pub noise_floor: Option<f64>,
}

/// Runs the free-run simulation of [`compare_under`](crate::compare_under()) under these conditions, bit for bit, at the cost of one
/// simulation and in a bounded number of steps, whatever the parameters are.
///
/// # Errors
/// [`CompareError`]: the log cannot drive the model or has no signal of it, or the simulation was aborted.
pub fn free_run(
    parameters: &PlantParameters,
    log: &Recording,
    conditions: &LogConditions,
) -> Result<FreeRun, CompareError> {
    let original = log;
    let log = &*united(parameters, original);
    let surroundings = Surroundings::of(parameters, log)?;
    let parameters = &*surroundings.around(parameters);
    let commands = Commands::new(parameters, log)?;
    let mut setup = Setup::new(parameters, (log, conditions), Tolerance::default())?;
    let (measured, _) = measured_signals(parameters, LogAsRead { log, original }, &commands)?;
    let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
    let (_, level) = start(parameters, pressure, &commands);
    setup.begin_at(pressure, level);
    let run = setup.free_run()?;
    let errors = measured.iter().map(|signal| SignalError {
        name: signal.name,
        unit: signal.error_unit.symbol(),
        rms: run
            .get(signal.name)
            .and_then(|modelled| rms(&residual(&signal.values, modelled))),
        noise_floor: signal.floor.summary.value,
    });
    Ok(FreeRun {
        errors: errors.collect(),
        model: run.into_recording(
            format!("free run of the model of {}", log.provenance().source),
            setup.base,
            &measured,
        )?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Bench;
    use crate::{CompareOptions, compare};

    #[test]
    fn a_free_run_is_the_one_of_the_comparison_bit_for_bit() {
        let log = Bench::default().measure();
        let plant = PlantParameters::nominal();
        let compared = compare(&plant, &log, &CompareOptions::default()).unwrap();
        let found = free_run(&plant, &log, &LogConditions::default()).unwrap();
        assert_eq!(found.errors.len(), compared.signals.len());
        for (error, expected) in found.errors.iter().zip(&compared.signals) {
            assert_eq!(error.name, expected.name);
            assert_eq!(error.unit, expected.unit);
            assert_eq!(error.rms, Some(expected.free_run.rms));
            assert_eq!(error.noise_floor, expected.noise_floor.value);
        }
        let traces = |model: &Recording| model.signal("p_ch").unwrap().values_or_nan().to_vec();
        assert_eq!(traces(&found.model), traces(&compared.traces.free_run));
    }
}
