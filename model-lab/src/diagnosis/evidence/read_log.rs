//! Content of a log before the noise of its sensors is known.

use plant_sim::PlantParameters;
use plant_sim::replay::{Inputs, ReplayInput, SUPPLY_PRESSURE, Surroundings, united};
use recording::Recording;

use super::sensor_noise::SensorNoise;
use crate::commands::Commands;
use crate::diagnosis::error::DiagnoseError;
use crate::error::CompareError;
use crate::measured::{
    FITTED_SIGNALS, GAS_TEMPERATURE, LogAsRead, Measured, PRESSURE, is_fitted_signal,
    measured_signals,
};
use crate::result::{NotCompared, Warning};
use crate::warning::{out_of_reach, warnings};

/// Content of a log before the noise of its sensors is known.
pub(crate) struct Read {
    pub(crate) commands: Commands,
    pub(crate) inputs: Vec<ReplayInput>,
    pub(crate) interval_s: f64,
    pub(crate) command_interval_s: f64,
    pub(crate) current_interval_s: f64,
    pub(crate) measured: Vec<Measured>,
    pub(crate) not_compared: Vec<NotCompared>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) surroundings: Surroundings,
}

impl Read {
    pub(crate) fn of(
        parameters: &PlantParameters,
        original: &Recording,
    ) -> Result<Self, DiagnoseError> {
        let log = &*united(parameters, original);
        let surroundings = Surroundings::of(parameters, log).map_err(CompareError::from)?;
        let parameters = &*surroundings.around(parameters);
        let commands = Commands::new(parameters, log).map_err(CompareError::from)?;
        let of_log = Inputs::of(parameters, log).map_err(CompareError::from)?;
        let mut inputs: Vec<ReplayInput> = of_log.iter().collect();
        commands.gaps.shorten(&mut inputs);
        let (measured, mut not_compared) =
            measured_signals(parameters, LogAsRead { log, original }, &commands)?;
        not_compared.retain(|signal| {
            let name = signal.name.as_str();
            FITTED_SIGNALS.contains(&name) || [SUPPLY_PRESSURE, GAS_TEMPERATURE].contains(&name)
        });
        let has_temperature = measured.iter().any(|one| one.name == GAS_TEMPERATURE);
        if has_temperature && !is_fitted_signal(parameters, GAS_TEMPERATURE) {
            not_compared.push(NotCompared {
                name: GAS_TEMPERATURE.to_owned(),
                reason: "the gas of this plant keeps its temperature: add the effect gas_temperature to the plant file"
                    .to_owned(),
            });
        }
        let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
        let values = pressure.map_or(&[][..], |pressure| &pressure.values);
        if let Some(statement) = out_of_reach(parameters, log, values) {
            return Err(DiagnoseError::PressureOutOfReach {
                log: log.provenance().source.clone(),
                statement,
            });
        }
        Ok(Self {
            warnings: warnings(parameters, log, &commands, &measured),
            interval_s: of_log.interval_s(),
            command_interval_s: of_log.command_interval_s(),
            current_interval_s: of_log.current_interval_s(),
            commands,
            inputs,
            measured,
            not_compared,
            surroundings,
        })
    }

    /// Adds the noise of the sensors in this log to `noise`.
    pub(crate) fn add_noise_to(&self, noise: &mut SensorNoise) {
        noise.add(&self.measured);
    }
}
