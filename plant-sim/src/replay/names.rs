//! Names in a log that the model does not know, and what they may mean.

use recording::{Quantity, Recording, Signal, Unit, nearest_name};

use super::{
    AMBIENT_PRESSURE, AMBIENT_TEMPERATURE, COIL_TEMPERATURE, ROW_SIGNALS, SUPPLY_PRESSURE, signals,
};
use crate::parameters::PlantParameters;

/// Signals that a replay uses and a model does not have.
const KNOWN: [&str; 4] = [
    SUPPLY_PRESSURE,
    AMBIENT_PRESSURE,
    AMBIENT_TEMPERATURE,
    COIL_TEMPERATURE,
];

/// A signal of a log that the model does not know by its name, and so does not use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownSignal {
    /// Its name in the log.
    pub name: String,
    /// Signals of the model that the log lacks and that it may be; the nearest name alone where one is near.
    pub nearest: Vec<&'static str>,
}

/// Returns the signals of `log` that may be one that the model has and the log lacks, under another name.
pub fn unknown_signals(parameters: &PlantParameters, log: &Recording) -> Vec<UnknownSignal> {
    let lacking: Vec<(&'static str, Unit)> = signals(parameters)
        .filter(|(name, _)| !log.mentions(name))
        .collect();
    let is_known = |signal: &&Signal| {
        let mut names = ROW_SIGNALS.iter().map(|(name, _)| *name);
        KNOWN.contains(&signal.name()) || names.any(|name| signal.name() == name)
    };
    log.signals()
        .iter()
        .filter(|signal| !is_known(signal))
        .map(|signal| UnknownSignal {
            name: signal.name().to_owned(),
            nearest: nearest(signal, &lacking),
        })
        .filter(|unknown| !unknown.nearest.is_empty())
        .collect()
}

/// Those of `lacking` that `signal` may be: of its quantity, and with a name like it where there is one.
fn nearest(signal: &Signal, lacking: &[(&'static str, Unit)]) -> Vec<&'static str> {
    let quantity = signal.unit().quantity();
    let alike = lacking
        .iter()
        .filter(|(_, unit)| unit.quantity() == quantity);
    let names: Vec<&'static str> = alike.map(|(name, _)| *name).collect();
    match nearest_name(signal.name(), names.iter().copied()) {
        Some(name) => vec![name],
        // A rig has many voltages and temperatures, but hardly a pressure or a duty cycle that is none of these.
        None if matches!(
            quantity,
            Quantity::Pressure | Quantity::Ratio | Quantity::DutyCycle
        ) =>
        {
            names
        }
        None => Vec::new(),
    }
}

/// Signals and channels of `log` that may be meant by `wanted`.
pub(super) fn meant_by(
    parameters: &PlantParameters,
    log: &Recording,
    wanted: &'static str,
) -> Vec<String> {
    let unknown = unknown_signals(parameters, log).into_iter();
    let signals = unknown.filter(|signal| signal.nearest.contains(&wanted));
    let left_out = log.left_out().iter();
    let channels = left_out.filter(|one| nearest_name(&one.name, [wanted].into_iter()).is_some());
    signals
        .map(|signal| signal.name)
        .chain(channels.map(|one| format!("{} ({})", one.name, one.reason)))
        .collect()
}
