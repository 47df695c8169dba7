//! Names in a log that are unknown to the model, and their possible meanings.

use recording::{Quantity, Recording, Signal, Unit, nearest_name};

use super::{
    ACTUATOR_POSITION, AMBIENT_PRESSURE, AMBIENT_TEMPERATURE, COIL_TEMPERATURE, ROW_SIGNALS,
    SUPPLY_PRESSURE, signals,
};
use crate::parameters::PlantParameters;

/// Signals that a replay uses and that are not signals of the model.
const KNOWN: [&str; 5] = [
    ACTUATOR_POSITION,
    SUPPLY_PRESSURE,
    AMBIENT_PRESSURE,
    AMBIENT_TEMPERATURE,
    COIL_TEMPERATURE,
];

/// Signal of a log whose name is unknown to the model, which therefore does not use it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownSignal {
    /// Name in the log.
    pub name: String,
    /// Signals of the model that the log lacks and that it may be; only the nearest name if one is near.
    pub nearest: Vec<&'static str>,
}

/// Returns the signals of `log` that may be a missing signal of the model under another name.
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

/// Returns the signals of `lacking` that `signal` may be: with its quantity, and with a similar name if there is one.
fn nearest(signal: &Signal, lacking: &[(&'static str, Unit)]) -> Vec<&'static str> {
    let quantity = signal.unit().quantity();
    let alike = lacking
        .iter()
        .filter(|(_, unit)| unit.quantity() == quantity);
    let names: Vec<&'static str> = alike.map(|(name, _)| *name).collect();
    match nearest_name(signal.name(), names.iter().copied()) {
        Some(name) => vec![name],
        // A rig has many other voltages and temperatures, but hardly any other pressures or duty cycles.
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

/// Returns the signals and channels of `log` that `wanted` may mean.
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
